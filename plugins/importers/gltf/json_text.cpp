#include "json_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace gltf_import {
namespace {

// glTF needs about ten levels; `extras` may hold anything.
constexpr size_t kMostLevels = 128;

class Checker {
 public:
    Checker(std::string_view text, size_t first_byte) : text_(text), first_byte_(first_byte) {}

    void run() {
        if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;  // a byte order mark
        bool may_close = false;                             // an array or object may end here, because it is empty
        for (;;) {
            skip_blanks();
            const char c = peek();
            if (may_close && c == (open_.back() == '{' ? '}' : ']')) {
                if (close()) return;
            } else {
                if (!open_.empty() && open_.back() == '{') member_name(may_close);
                skip_blanks();
                may_close = peek() == '{' || peek() == '[';
                if (may_close) {
                    if (open_.size() == kMostLevels) fail("at most 128 arrays and objects inside each other");
                    open_ += text_[at_++];
                    continue;
                }
                scalar();
            }
            while (!separator()) {
                if (close()) return;
            }
            may_close = false;
        }
    }

 private:
    char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip_blanks() {
        while (at_ < text_.size() && std::strchr(" \t\r\n", text_[at_]) && text_[at_]) ++at_;
    }

    // Leaves an array or object. Returns true if it was the outermost, which must be the end of the text.
    bool close() {
        ++at_;
        open_.pop_back();
        if (!open_.empty()) return false;
        end();
        return true;
    }
    void end() {
        skip_blanks();
        if (at_ < text_.size()) fail("the end of the text");
    }
    // Call it behind a value. Returns false if the array or object ends.
    bool separator() {
        if (open_.empty()) fail("an object");
        skip_blanks();
        if (peek() == ',') return ++at_, true;
        const bool in_object = open_.back() == '{';
        if (peek() != (in_object ? '}' : ']')) fail(in_object ? "',' or '}' after a member" : "',' or ']' after an element");
        return false;
    }

    void member_name(bool may_close) {
        if (peek() != '"')
            fail(may_close ? "the name of a member in double quotes, or '}'" : "the name of a member in double quotes");
        string();
        skip_blanks();
        if (peek() != ':') fail("':' after the name of a member");
        ++at_;
    }

    void scalar() {
        const char c = peek();
        if (open_.empty()) fail("'{', with which a glTF file begins");
        if (c == '"') return string();
        if (c == '-' || (c >= '0' && c <= '9')) return number();
        for (const std::string_view word : {"true", "false", "null"}) {
            if (text_.substr(at_, word.size()) != word) continue;
            at_ += word.size();
            return;
        }
        fail("a value: a string, a number, true, false, null, '[' or '{'");
    }

    void digits() {
        if (!is_digit(peek())) fail("a digit");
        while (is_digit(peek())) ++at_;
    }
    void number() {
        const size_t first = at_;
        if (peek() == '-') ++at_;
        if (peek() == '0') {
            if (is_digit(text_.substr(at_ + 1, 1).empty() ? '\0' : text_[at_ + 1])) fail("a number without leading zeros");
            ++at_;
        } else {
            digits();
        }
        if (peek() == '.') ++at_, digits();
        if (peek() == 'e' || peek() == 'E') {
            ++at_;
            if (peek() == '+' || peek() == '-') ++at_;
            digits();
        }
        if (std::isfinite(std::strtod(std::string(text_.substr(first, at_ - first)).c_str(), nullptr))) return;
        at_ = first;
        fail("a number that a computer can hold");
    }

    unsigned hex4() {
        unsigned value = 0;
        for (int i = 0; i < 4; ++i, ++at_) {
            const char c = peek();
            const bool is_letter = (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
            if (!is_digit(c) && !is_letter) fail("four hexadecimal digits after \\u");
            value = 16 * value + unsigned(is_letter ? (c | 0x20) - 'a' + 10 : c - '0');
        }
        return value;
    }
    void escape() {
        ++at_;
        const char c = peek();
        if (!c || !std::strchr("\"\\/bfnrtu", c)) fail("one of \" \\ / b f n r t u after a backslash");
        ++at_;
        if (c != 'u') return;
        const unsigned unit = hex4();
        if (unit < 0xD800 || unit > 0xDFFF) return;
        const bool is_pair = unit < 0xDC00 && text_.substr(at_, 2) == "\\u";
        if (is_pair) at_ += 2;
        const unsigned second = is_pair ? hex4() : 0;
        if (second < 0xDC00 || second > 0xDFFF) fail("both halves of a surrogate pair");
    }
    // Passes one character of well-formed UTF-8 (table 3-7 of the Unicode standard).
    void utf8() {
        const auto byte = [&](size_t i) { return at_ + i < text_.size() ? static_cast<unsigned char>(text_[at_ + i]) : 0u; };
        const unsigned lead = byte(0), second = byte(1);
        const size_t bytes = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
        bool is_good = bytes > 0;
        for (size_t i = 1; i < bytes; ++i) is_good = is_good && (byte(i) & 0xC0) == 0x80;
        if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second > 0x9F)) is_good = false;
        if ((lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second > 0x8F)) is_good = false;
        if (!is_good) fail("text in UTF-8");
        at_ += bytes;
    }
    void string() {
        const size_t first = at_++;
        for (;;) {
            // A data URI can be most of the file.
            while (at_ < text_.size() && text_[at_] >= ' ' && text_[at_] != '"' && text_[at_] != '\\') ++at_;
            if (at_ == text_.size()) {
                at_ = first;
                fail("a string with its second '\"'");
            }
            if (text_[at_] == '"') break;
            if (text_[at_] == '\\') {
                escape();
            } else {
                if (static_cast<unsigned char>(text_[at_]) < ' ')
                    fail("no control characters in a string (is a '\"' missing?)");
                utf8();
            }
        }
        ++at_;
    }

    static bool is_digit(char c) { return c >= '0' && c <= '9'; }

    [[noreturn]] void fail(const std::string& expected) const {
        const std::string_view before = text_.substr(0, at_), rest = text_.substr(at_, 24);
        const size_t line = size_t(std::count(before.begin(), before.end(), '\n')) + 1;
        const size_t line_first = before.rfind('\n') + 1;  // npos + 1 is 0
        const size_t column = size_t(std::count_if(before.begin() + std::ptrdiff_t(line_first), before.end(),
                                                   [](char c) { return (c & 0xC0) != 0x80; }));
        std::string found = "the end of the text";
        if (!rest.empty() && static_cast<unsigned char>(rest[0] - '!') < '~' - ' ') {
            size_t end = 1;
            while (end < rest.size() && rest[end] > ' ' &&
                   (rest[0] == '"' ? rest[end - 1] != '"' || end == 1 : !std::strchr(",:[]{}\"", rest[end]))) {
                ++end;
            }
            found = in_quotes(std::strchr(",:[]{}", rest[0]) ? rest.substr(0, 1) : rest.substr(0, end));
        } else if (!rest.empty()) {
            static const char* const hex = "0123456789ABCDEF";
            const auto byte = static_cast<unsigned char>(rest[0]);
            found = std::string("the byte 0x") + hex[byte >> 4] + hex[byte & 15];
        }
        throw Error("line " + std::to_string(line) + ", column " + std::to_string(column + 1) + " (byte " +
                    std::to_string(first_byte_ + at_) + "): found " + found + ", expected " + expected);
    }

    const std::string_view text_;
    const size_t first_byte_;
    size_t at_ = 0;
    std::string open_;  // the brackets that are open
};

}  // namespace

std::string in_quotes(std::string_view text) {
    std::string out = "'";
    for (const char c : text.substr(0, 60)) out += c >= ' ' && c <= '~' ? c : '?';
    return out + (text.size() > 60 ? "...'" : "'");
}

void check_json(std::string_view text, size_t first_byte) {
    Checker(text, first_byte).run();
}

}  // namespace gltf_import
