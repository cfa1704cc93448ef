#include "xml_check.hpp"

#include "xml_reader.hpp"

namespace assimp_import {

std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 60 ? "...'" : "'");
}

std::string xml_damage(std::string_view text) {
    if (text.substr(0, 2) == "\xFE\xFF" || text.substr(0, 2) == "\xFF\xFE") return {};  // UTF-16
    return damage_of([&] { Reader(text, {}).run(); });
}

}  // namespace assimp_import
