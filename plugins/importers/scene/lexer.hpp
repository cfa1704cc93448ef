// lexer.hpp -- a scene file's bytes as lines of words.
#pragma once
#include <optional>
#include <string_view>
#include <vector>

#include "diagnostics.hpp"

namespace scene_format {

inline constexpr size_t kMaxFileBytes = 256u << 20;
inline constexpr size_t kMaxLineBytes = 1u << 20;  // a polygon of some 50 000 corners
inline constexpr size_t kMaxLines = 10'000'000;

struct Token {
    std::string_view text;  // without the quotes; points into the file's text
    Position position;      // of its first character, the quote if there is one
    bool is_quoted = false;
};

// Words are separated by spaces and tabs; "..." holds spaces and # too (no escapes: a backslash is a backslash); # outside
// quotes starts a comment. Lines end with LF, CR LF or CR. Outside comments only UTF-8 text without control characters is
// accepted: the names end up in JSON, in logs and on terminals.
class Lexer {
 public:
    explicit Lexer(std::string_view text);

    // The next line that holds words; false at the end of the file. Throws StatementError, then goes on with the next line.
    bool next_line(std::vector<Token>& tokens);
    // Just behind the last word of the line that next_line read.
    Position line_end() const { return line_end_; }
    // How far the file is read, 0..1.
    float fraction() const { return text_.empty() ? 1.0f : static_cast<float>(at_) / static_cast<float>(text_.size()); }

 private:
    std::string_view cut_line();
    void split(std::string_view line, std::vector<Token>& tokens);

    std::string_view text_;
    size_t at_ = 0;
    uint32_t line_ = 0;
    Position line_end_;
};

// Why a word is no number that a scene can hold.
enum class NumberError { none, not_a_number, trailing_text, out_of_range };
struct Number {
    float value = 0;
    NumberError error = NumberError::none;
};
// The host takes larger coordinates for not finite: sums of areas would overflow.
inline constexpr float kMaxNumber = 1e15f;
// Decimal, with an optional sign, fraction and exponent, whatever the locale. No infinity, no NaN, no hexadecimal.
Number parse_number(std::string_view text);

}  // namespace scene_format
