#include "lexer.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>

namespace scene_format {
namespace {

// Returns the length in bytes of the UTF-8 character at the start of `text`, or 0 if it is malformed (RFC 3629: no overlong
// forms, no surrogates).
size_t character_bytes(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto continues = [&](size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    if (first >= 0xC2 && first <= 0xDF) return continues(1) ? 2 : 0;
    if (first >= 0xE0 && first <= 0xEF) {
        if (!continues(1) || !continues(2)) return 0;
        if ((first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) >= 0xA0)) return 0;
        return 3;
    }
    if (first >= 0xF0 && first <= 0xF4) {
        if (!continues(1) || !continues(2) || !continues(3)) return 0;
        if ((first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) >= 0x90)) return 0;
        return 4;
    }
    return 0;
}

std::string byte_text(char c) {
    char text[8];
    std::snprintf(text, sizeof text, "0x%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
    return text;
}

// Moves over the characters of one line and counts columns. Throws StatementError at a character that is not allowed.
struct Cursor {
    std::string_view line;
    Position position;
    size_t at = 0;

    bool done() const { return at >= line.size(); }
    char look() const { return line[at]; }
    void step() {
        const unsigned char c = static_cast<unsigned char>(look());
        if ((c < 0x20 && c != '\t') || c == 0x7F) {
            throw StatementError{
                position, "byte " + byte_text(look()) + " is a control character; expected text (is this a scene file?)", true};
        }
        const size_t bytes = character_bytes(line.substr(at));
        if (bytes == 0) {
            throw StatementError{position, "byte " + byte_text(look()) + " is not UTF-8; save the file as UTF-8"};
        }
        at += bytes;
        ++position.column;
    }
};

bool is_space(char c) {
    return c == ' ' || c == '\t';
}

}  // namespace

bool Lexer::next_line(std::vector<Token>& tokens) {
    tokens.clear();
    for (std::string_view line; lines_.next(line);) {
        if (lines_.number() > kMaxLines) {
            const uint32_t line_number = this->line_number();
            lines_ = importers::Lines({});
            throw StatementError{{line_number, 1},
                                 "the file has more than " + std::to_string(kMaxLines) +
                                     " lines; give large meshes as PLY or OBJ and `load` them",
                                 true};
        }
        if (line.size() > kMaxLineBytes) {
            throw StatementError{
                {line_number(), 1},
                "the line has " + std::to_string(line.size()) + " bytes; expected at most " + std::to_string(kMaxLineBytes)};
        }
        split(line, tokens);
        if (!tokens.empty()) return true;
    }
    return false;
}

void Lexer::split(std::string_view line, std::vector<Token>& tokens) {
    Cursor cursor{line, {line_number(), 1}};
    line_end_ = cursor.position;
    while (!cursor.done()) {
        if (is_space(cursor.look())) {
            cursor.step();
            continue;
        }
        if (cursor.look() == '#') return;
        Token token;
        token.position = cursor.position;
        token.is_quoted = cursor.look() == '"';
        if (token.is_quoted) {
            cursor.step();
            const size_t start = cursor.at;
            while (!cursor.done() && cursor.look() != '"') {
                // Names go into messages and listings, where a tab would look like a separator.
                if (cursor.look() == '\t') throw StatementError{cursor.position, "a tab inside quotes; expected a space"};
                cursor.step();
            }
            if (cursor.done())
                throw StatementError{token.position, "the line ends inside the quotes that open here; expected `\"`"};
            token.text = line.substr(start, cursor.at - start);
            cursor.step();
            if (!cursor.done() && !is_space(cursor.look()) && cursor.look() != '#') {
                throw StatementError{cursor.position, "text right behind closing quotes; expected a space"};
            }
        } else {
            const size_t start = cursor.at;
            while (!cursor.done() && !is_space(cursor.look()) && cursor.look() != '#') {
                if (cursor.look() == '"')
                    throw StatementError{cursor.position, "quotes inside a word; expected them around it"};
                cursor.step();
            }
            token.text = line.substr(start, cursor.at - start);
        }
        tokens.push_back(token);
        line_end_ = cursor.position;
    }
}

Number parse_number(std::string_view text) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);  // from_chars does not accept a plus sign
    double value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status == std::errc::invalid_argument) return {0, NumberError::not_a_number};
    if (end != text.data() + text.size()) return {0, NumberError::trailing_text};
    // Compared as floats: 1e15 is more than the float that is nearest to it.
    const auto rounded = static_cast<float>(std::clamp(value, -1e30, 1e30));
    if (status != std::errc() || !(std::fabs(rounded) <= kMaxNumber)) return {0, NumberError::out_of_range};
    return {rounded, NumberError::none};
}

}  // namespace scene_format
