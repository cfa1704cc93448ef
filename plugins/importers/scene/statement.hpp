// statement.hpp -- reads the words of one statement: names, numbers, and `key value ...` pairs in any order.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "document.hpp"
#include "lexer.hpp"

namespace scene_format {

struct Key {
    std::string_view name;
    bool repeats = false;
};

class Statement {
 public:
    // The first token is the word of the statement. The calls below read the following tokens, and all of them throw
    // StatementError.
    Statement(const std::vector<Token>& tokens, Position end);

    std::string_view word() const { return tokens_[0].text; }
    Position position() const { return tokens_[0].position; }
    // The position of the next word, or of the line's end.
    Position next() const { return done() ? end_ : tokens_[at_].position; }
    // The position of the last word that was read.
    Position last() const { return tokens_[at_ - 1].position; }
    bool done() const { return at_ == tokens_.size(); }
    // Whether the next word is a key of this statement.
    bool at_key() const;

    // Sets the keys of this statement. key() returns the index of the next one. A list of numbers ends where one of these keys
    // follows.
    void expect_keys(std::vector<Key> keys);
    size_t key();
    bool given(size_t key) const { return key_positions_[key].line != 0; }

    // `what` names the expected thing in error messages, for example "the material's name".
    Name name(std::string_view what);
    std::string path(std::string_view what);
    // Reads one of these words and returns its index.
    size_t choice(std::string_view what, const std::vector<std::string_view>& words);

    // `what` is, for example, "`center` (x y z)". Errors name the position in a list as "number 2 of 3".
    float number(std::string_view what, size_t index = 0, size_t count = 1);
    float number_between(std::string_view what, float least, float most);
    Vec3 vector(std::string_view what);
    Vec3 direction(std::string_view what);             // returns unit length; zero is an error
    Vec3 color(std::string_view what, float most);     // 3 numbers, or one for grey; each 0..most
    Vec3 scale(std::string_view what);                 // 3 numbers, or one for all axes; none may be zero
    std::vector<float> points(std::string_view what);  // 3 numbers per point, up to the next key
    // Numbers up to the next key, at least `group` and a multiple of it.
    std::vector<float> numbers(std::string_view what, size_t group, float least, float most);

    void expect_end();
    [[noreturn]] void fail_at_last(const std::string& message) const { throw StatementError{last(), message}; }

 private:
    const Token& take(const std::string& expected);
    // Where 3 numbers may be one: whether what follows the first is no number. A key that nobody knows is then called so.
    bool one_was_enough() const;
    void check_range(std::string_view what, float value, float least, float most) const;
    std::string text(std::string_view what, size_t most_bytes);
    std::vector<std::string_view> key_names() const;

    const std::vector<Token>& tokens_;
    Position end_;
    size_t at_ = 1;
    std::vector<Key> keys_;
    std::vector<Position> key_positions_;  // line 0: the key was not given
};

}  // namespace scene_format
