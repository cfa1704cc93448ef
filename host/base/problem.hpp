// problem.hpp -- what is wrong with something, in words for the user; or nothing.
#pragma once
#include <ostream>
#include <string>
#include <utility>

#include "base/error.hpp"

namespace clarity {

//   if (const Problem problem = validate(scene)) throw Error(Exit::import_failed, problem.text());
class [[nodiscard]] Problem {
 public:
    Problem() = default;  // nothing is wrong
    Problem(std::string text, Failure failure = Failure::other) : text_(std::move(text)), failure_(failure) {}
    Problem(const char* text) : text_(text) {}
    explicit operator bool() const { return !text_.empty(); }
    const std::string& text() const { return text_; }
    Failure failure() const { return failure_; }

    friend bool operator==(const Problem& a, const Problem& b) { return a.text_ == b.text_; }
    friend bool operator!=(const Problem& a, const Problem& b) { return a.text_ != b.text_; }
    friend std::ostream& operator<<(std::ostream& out, const Problem& problem) { return out << problem.text_; }

 private:
    std::string text_;
    Failure failure_ = Failure::other;
};

}  // namespace clarity
