#include "file_kind.hpp"

#include <cctype>
#include <string_view>

namespace assimp_import {
namespace {

bool starts_with(std::string_view text, std::string_view start) {
    return text.substr(0, start.size()) == start;
}

// Returns the text without a byte order mark and leading white space.
std::string_view trimmed(std::string_view text) {
    if (starts_with(text, "\xEF\xBB\xBF")) text.remove_prefix(3);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    return text;
}

}  // namespace

int certainty(const uint8_t* head, size_t bytes) {
    const std::string_view text(reinterpret_cast<const char*>(head), bytes);
    if (starts_with(text, "glTF")) return 100;
    if (text.substr(0, 1024).find("<COLLADA") != text.npos) return 90;
    if (starts_with(trimmed(text), "{") && text.find("\"asset\"") != text.npos) return 60;
    return 0;
}

}  // namespace assimp_import
