// text.hpp -- splits text formats into lines and words, and parses numbers.
#pragma once
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

namespace openmesh_import {

inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

inline std::string_view trim(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

// Removes the first word from `text` and returns it; empty if there is none.
inline std::string_view next_word(std::string_view& text) {
    size_t start = 0;
    while (start < text.size() && is_blank(text[start])) ++start;
    size_t end = start;
    while (end < text.size() && !is_blank(text[end])) ++end;
    const std::string_view word = text.substr(start, end - start);
    text.remove_prefix(end);
    return word;
}

// Removes the first line from `text` and returns it without its end (\n or \r\n).
inline std::string_view next_line(std::string_view& text) {
    const size_t end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
}

inline std::string_view before_comment(std::string_view line) {
    return line.substr(0, line.find('#'));
}

// Parses the whole word as a finite float. Values too small for a float become 0. Returns false for nan, inf, 1e999 and other
// words.
inline bool parse_float(std::string_view word, float& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    double wide = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), wide);
    if (end != word.data() + word.size() || word.empty()) return false;
    if (error == std::errc::result_out_of_range) {
        if (word.find("e-") == word.npos && word.find("E-") == word.npos) return false;
        wide = 0;
    } else if (error != std::errc()) {
        return false;
    }
    value = static_cast<float>(wide);
    return std::isfinite(value);
}

inline bool parse_integer(std::string_view word, long long& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size() && !word.empty();
}

// Returns, for example, "1 face" or "3 faces".
inline std::string counted(unsigned long long count, const char* what) {
    return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

// Returns the text for a message: shortened, and '?' in place of characters that cannot be printed.
inline std::string printable(std::string_view text) {
    std::string out;
    for (const char c : trim(text).substr(0, 40)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (trim(text).size() > 40 ? "..." : "");
}
inline std::string quoted(std::string_view text) {
    return "'" + printable(text) + "'";
}

}  // namespace openmesh_import
