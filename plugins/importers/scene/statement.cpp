#include "statement.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

namespace scene_format {
namespace {

constexpr size_t kMaxNameBytes = 255, kMaxPathBytes = 4096;

std::string short_number(float value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", static_cast<double>(value));
    return text;
}

}  // namespace

Statement::Statement(const std::vector<Token>& tokens, Position end) : tokens_(tokens), end_(end) {}

const Token& Statement::take(const std::string& expected) {
    if (done()) throw StatementError{end_, "the line ends here; expected " + expected};
    return tokens_[at_++];
}

// ---- keys

void Statement::expect_keys(std::vector<Key> keys) {
    keys_ = std::move(keys);
    key_positions_.assign(keys_.size(), {});
}

std::vector<std::string_view> Statement::key_names() const {
    std::vector<std::string_view> names;
    for (const Key& key : keys_) names.push_back(key.name);
    return names;
}

bool Statement::at_key() const {
    if (done() || tokens_[at_].is_quoted) return false;
    for (const Key& key : keys_) {
        if (key.name == tokens_[at_].text) return true;
    }
    return false;
}

bool Statement::one_was_enough() const {
    if (done()) return true;
    return !tokens_[at_].is_quoted && parse_number(tokens_[at_].text).error == NumberError::not_a_number;
}

size_t Statement::key() {
    const Token& token = tokens_[at_++];
    const std::string keys = " (keys of " + std::string(word()) + ": " + listed(key_names()) + ")";
    if (token.is_quoted)
        throw StatementError{token.position, "text in quotes, " + in_quotes(token.text) + "; expected a key" + keys};
    for (size_t i = 0; i < keys_.size(); ++i) {
        if (keys_[i].name != token.text) continue;
        if (given(i) && !keys_[i].repeats) {
            throw StatementError{token.position, "key " + in_quotes(token.text) +
                                                     " for the second time; the first is in column " +
                                                     std::to_string(key_positions_[i].column)};
        }
        key_positions_[i] = token.position;
        return i;
    }
    if (parse_number(token.text).error != NumberError::not_a_number) {
        throw StatementError{token.position,
                             "number " + in_quotes(token.text) + " is one too many; expected a key or the line's end" + keys};
    }
    throw StatementError{token.position, "unknown key " + in_quotes(token.text) + suggestion(token.text, key_names()) + keys};
}

void Statement::expect_end() {
    if (done()) return;
    throw StatementError{tokens_[at_].position,
                         in_quotes(tokens_[at_].text) + " is one word too many; expected the line's end"};
}

// ---- words

std::string Statement::text(std::string_view what, size_t most_bytes) {
    if (at_key()) {
        throw StatementError{tokens_[at_].position, "key " + in_quotes(tokens_[at_].text) + "; expected " + std::string(what) +
                                                        " (in quotes, if that is what it is)"};
    }
    const Token& token = take(std::string(what));
    if (token.text.empty()) throw StatementError{token.position, "empty quotes; expected " + std::string(what)};
    if (token.text.size() > most_bytes) {
        throw StatementError{token.position, std::to_string(token.text.size()) + " bytes; expected " + std::string(what) +
                                                 " of at most " + std::to_string(most_bytes)};
    }
    return std::string(token.text);
}

Name Statement::name(std::string_view what) {
    if (!done() && !tokens_[at_].is_quoted && parse_number(tokens_[at_].text).error != NumberError::not_a_number) {
        throw StatementError{tokens_[at_].position, "number " + in_quotes(tokens_[at_].text) + "; expected " +
                                                        std::string(what) + " (in quotes, if it looks like a number)"};
    }
    std::string read = text(what, kMaxNameBytes);
    return {std::move(read), last()};
}

std::string Statement::path(std::string_view what) {
    return text(what, kMaxPathBytes);
}

size_t Statement::choice(std::string_view what, const std::vector<std::string_view>& words) {
    const Token& token = take(std::string(what) + ": " + listed(words));
    for (size_t i = 0; i < words.size(); ++i) {
        if (!token.is_quoted && words[i] == token.text) return i;
    }
    throw StatementError{token.position, in_quotes(token.text) + " is no " + std::string(what) + suggestion(token.text, words) +
                                             " (expected: " + listed(words) + ")"};
}

// ---- numbers

float Statement::number(std::string_view what, size_t index, size_t count) {
    std::string expected = "a number for " + std::string(what);
    if (count > 1)
        expected = "number " + std::to_string(index + 1) + " of " + std::to_string(count) + " for " + std::string(what);
    const Token& token = take(expected);
    if (token.is_quoted)
        throw StatementError{token.position, "text in quotes, " + in_quotes(token.text) + "; expected " + expected};
    const Number number = parse_number(token.text);
    switch (number.error) {
        case NumberError::none:
            return number.value;
        case NumberError::not_a_number:
            throw StatementError{token.position, in_quotes(token.text) + " is no number; expected " + expected};
        case NumberError::trailing_text:
            throw StatementError{token.position,
                                 in_quotes(token.text) + " goes on behind a number; expected " + expected +
                                     (token.text.find(',') != std::string_view::npos ? " (the decimal sign is a point)" : "")};
        case NumberError::out_of_range:
            break;
    }
    throw StatementError{token.position, in_quotes(token.text) + " is out of range; expected " + expected +
                                             ", finite and of size " + short_number(kMaxNumber) + " at most"};
}

float Statement::number_between(std::string_view what, float least, float most) {
    const float value = number(what);
    check_range(what, value, least, most);
    return value;
}

void Statement::check_range(std::string_view what, float value, float least, float most) const {
    if (value >= least && value <= most) return;
    const std::string range = most < kMaxNumber ? " between " + short_number(least) + " and " + short_number(most)
                                                : " of " + short_number(least) + " at least";
    fail_at_last(in_quotes(tokens_[at_ - 1].text) + " is out of range; expected " + std::string(what) + range);
}

std::vector<float> Statement::numbers(std::string_view what, size_t group, float least, float most) {
    std::vector<float> all;
    while (!done() && !at_key()) {
        all.push_back(number(what, all.size() % group, group));
        check_range(what, all.back(), least, most);
    }
    if (!all.empty() && all.size() % group == 0) return all;
    throw StatementError{next(), std::to_string(all.size()) + " numbers for " + std::string(what) + "; expected " +
                                     (group > 1 ? std::to_string(group) + " for each point" : "one or more")};
}

Vec3 Statement::vector(std::string_view what) {
    Vec3 v{};
    for (size_t i = 0; i < 3; ++i) v[i] = number(what, i, 3);
    return v;
}

Vec3 Statement::direction(std::string_view what) {
    const Position start = done() ? end_ : tokens_[at_].position;
    const Vec3 v = vector(what);
    const double length = std::hypot(double{v[0]}, double{v[1]}, double{v[2]});
    if (!(length > 0))
        throw StatementError{start, "the zero vector has no direction; expected another for " + std::string(what)};
    return {static_cast<float>(v[0] / length), static_cast<float>(v[1] / length), static_cast<float>(v[2] / length)};
}

Vec3 Statement::color(std::string_view what, float most) {
    Vec3 c{};
    for (size_t i = 0; i < 3; ++i) {
        if (i == 1 && one_was_enough()) return {c[0], c[0], c[0]};
        c[i] = number(what, i, 3);
        if (c[i] < 0 || c[i] > most) {
            fail_at_last(in_quotes(tokens_[at_ - 1].text) + " is out of range; expected " + std::string(what) +
                         " in linear light, " + (most < kMaxNumber ? "0 to " + short_number(most) : std::string("0 or more")));
        }
    }
    return c;
}

Vec3 Statement::scale(std::string_view what) {
    Vec3 s{};
    for (size_t i = 0; i < 3; ++i) {
        if (i == 1 && one_was_enough()) return {s[0], s[0], s[0]};
        s[i] = number(what, i, 3);
        if (s[i] == 0) fail_at_last("zero flattens the object; expected another number for " + std::string(what));
    }
    return s;
}

std::vector<float> Statement::points(std::string_view what) {
    const Position start = done() ? end_ : tokens_[at_].position;
    std::vector<float> numbers;
    while (!done() && !at_key()) numbers.push_back(number(what, numbers.size() % 3, 3));
    if (numbers.size() % 3 != 0) {
        throw StatementError{done() ? end_ : tokens_[at_].position, std::to_string(numbers.size()) + " numbers for " +
                                                                        std::string(what) + "; expected three for each corner"};
    }
    if (numbers.size() < 9) {
        throw StatementError{
            start, std::to_string(numbers.size() / 3) + " corners for " + std::string(what) + "; expected at least 3"};
    }
    return numbers;
}

}  // namespace scene_format
