// text.hpp -- words and numbers of text formats, and texts for messages.
#pragma once
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <system_error>

#include "../common/text_lines.hpp"

namespace openmesh_import {

using importers::Lines;

inline bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r';
}

inline std::string_view trim(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

// Removes the first word from `text` and returns it; empty if there is none.
inline std::string_view next_word(std::string_view& text) {
    const char *at = text.data(), *const end = at + text.size();
    while (at < end && is_blank(*at)) ++at;
    const char* const start = at;
    while (at < end && !is_blank(*at)) ++at;
    text = {at, static_cast<size_t>(end - at)};
    return {start, static_cast<size_t>(at - start)};
}

// For lines of numbers: `#` begins a comment wherever it stands.
inline std::string_view before_comment(std::string_view line) {
    return line.substr(0, line.find('#'));
}

// For lines of names, which may hold a `#`: a comment begins where one stands behind a blank. Returns where that is from `from`
// on, or npos.
inline size_t comment_in_name(std::string_view line, size_t from = 0) {
    for (size_t at = line.find('#', from); at != line.npos; at = line.find('#', at + 1))
        if (at == 0 || is_blank(line[at - 1])) return at;
    return line.npos;
}

// Without the quotes around it, if it has some.
inline std::string_view without_quotes(std::string_view name) {
    const bool quoted = name.size() >= 2 && name.front() == '"' && name.back() == '"';
    return quoted ? trim(name.substr(1, name.size() - 2)) : name;
}

// Compares a word of the file with one in lower case.
inline bool is_word(std::string_view word, std::string_view lower) {
    if (word.size() != lower.size()) return false;
    for (size_t i = 0; i < word.size(); ++i) {
        const char c = word[i] >= 'A' && word[i] <= 'Z' ? static_cast<char>(word[i] - 'A' + 'a') : word[i];
        if (c != lower[i]) return false;
    }
    return true;
}

// Parses the whole word as a finite float, or as a double that is finite as a float. Values too small for a float become 0.
// Returns false for nan, inf, 1e999 and other words.
template <class Number>
bool parse_float(std::string_view word, Number& value) {
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
    value = static_cast<Number>(wide);
    return std::isfinite(static_cast<float>(wide));
}

inline bool parse_integer(std::string_view word, long long& value) {
    if (!word.empty() && word.front() == '+') word.remove_prefix(1);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size() && !word.empty();
}

// True for words such as nan, -nan(ind), inf, -1.#IND and 1e999, which programs write for numbers that are not finite.
inline bool is_odd_number(std::string_view word) {
    if (!word.empty() && (word.front() == '-' || word.front() == '+')) word.remove_prefix(1);
    if (word.empty()) return false;
    const char first = static_cast<char>(word.front() | 0x20);
    if (first == 'n' || first == 'i') return word.size() >= 3 && word.size() <= 8;
    return word.front() >= '0' && word.front() <= '9' && word.find_first_of("eE#") != word.npos;
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
