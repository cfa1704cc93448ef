// text.hpp -- texts for people and for programs: safe ones, counts with their nouns, amounts of memory, words of a shell.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace clarity {

// Replaces every control character and every byte that is not valid UTF-8 by \xNN. Line feeds and tabs stay. File names and
// messages of libraries may contain control characters, with which a hostile file could rewrite the screen, change the window's
// title or hide a warning.
std::string printable(std::string_view text);
// The same for text that must stay on one line: line feeds and tabs become \xNN too.
std::string printable_line(std::string_view text);
// A printable line for XML and HTML, as text or as the value of an attribute.
std::string markup_line(std::string_view text);

// Like printf, but makes the text printable. All text for people goes to stdout through this function; JSON does not need it.
[[gnu::format(printf, 1, 2)]] void print_text(const char* format, ...);

// Text in lower case, independent of the locale.

// Changes only the letters A to Z.
inline char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
inline std::string lower(std::string text) {
    for (char& c : text) c = lower(c);
    return text;
}

// Counts with their nouns, for people.

// The noun for a count: "ray" for 1, else "rays", or `many` where that is not the noun with an s.
inline std::string noun(uint64_t count, const std::string& one, const std::string& many = {}) {
    return count == 1 ? one : many.empty() ? one + "s" : many;
}

// "1 light", "3 lights"; with `many`: "1 ray was", "3 rays were".
inline std::string plural(uint64_t count, const std::string& one, const std::string& many = {}) {
    return std::to_string(count) + " " + noun(count, one, many);
}

// Amounts of memory as text.

// "12.3 GiB", "512 MiB", "1.5 MiB".
std::string memory_text(uint64_t bytes);
// Limits, in whole units: "12 GiB", "512 MiB", "100 bytes" (below one MiB, because "0 MiB" would not help).
std::string memory_limit_text(uint64_t bytes);

// Quotes a text so that a shell takes it for one word.
inline std::string shell_word(const std::string& text) {
    static const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,@%";
    if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
    std::string out = "'";
    for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

}  // namespace clarity
