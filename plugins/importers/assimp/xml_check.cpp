#include "xml_check.hpp"

#include "xml_reader.hpp"

namespace assimp_import {

std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 60 ? "...'" : "'");
}

std::string xml_damage(std::string_view text) {
    return damage_of(text, [&] { Reader(text, {}).run(); });
}

}  // namespace assimp_import
