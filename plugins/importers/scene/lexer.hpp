// lexer.hpp -- splits the text of a scene file into lines and words.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "../common/text_lines.hpp"
#include "diagnostics.hpp"

namespace scene_format {

inline constexpr size_t kMaxFileBytes = 256u << 20;
inline constexpr size_t kMaxLineBytes = 1u << 20;  // enough for a polygon of about 50 000 corners
inline constexpr size_t kMaxLines = 10'000'000;

struct Token {
    std::string_view text;  // without the quotes; points into the text of the file
    Position position;      // of the first character, or of the opening quote
    bool is_quoted = false;
};

// Words are separated by spaces and tabs. Text in quotes ("...") is one word and may contain spaces and #. There are no
// escapes: a backslash is a backslash. A # outside quotes starts a comment. Lines end with LF, CR LF or CR. Outside comments,
// only UTF-8 text without control characters is accepted, because names end up in JSON, in logs and on terminals.
class Lexer {
 public:
    explicit Lexer(std::string_view text) : lines_(text) {}

    // Reads the next line that has words. Returns false at the end of the file. Throws StatementError for a bad line; the next
    // call continues with the line after it.
    bool next_line(std::vector<Token>& tokens);
    // The position just behind the last word of the line that next_line() read.
    Position line_end() const { return line_end_; }
    // The fraction of the file that has been read, 0..1.
    float fraction() const { return lines_.fraction(); }

 private:
    uint32_t line_number() const { return static_cast<uint32_t>(lines_.number()); }
    void split(std::string_view line, std::vector<Token>& tokens);

    importers::Lines lines_;
    Position line_end_;
};

// Why a word is not a valid number.
enum class NumberError { none, not_a_number, trailing_text, out_of_range };
struct Number {
    float value = 0;
    NumberError error = NumberError::none;
};
// Largest absolute value of a number. The host treats larger coordinates as not finite, because sums of areas would overflow.
inline constexpr float kMaxNumber = 1e15f;
// Parses a decimal number with an optional sign, fraction and exponent, in any locale. It accepts no infinity, no NaN and no
// hexadecimal.
Number parse_number(std::string_view text);

}  // namespace scene_format
