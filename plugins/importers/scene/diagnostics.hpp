// diagnostics.hpp -- errors and warnings of one scene file, each at a line and column.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scene_format {

// Both from 1; a column is one character (UTF-8 code point), a tab counts as one.
struct Position {
    uint32_t line = 0, column = 0;
};

// Thrown where a statement cannot be understood; the parser notes it and goes on with the next line.
struct StatementError {
    Position position;
    std::string message;
    bool ends_reading = false;  // what follows would only be noise
};

struct Diagnostic {
    Position position;
    std::string message;
};

class Diagnostics {
 public:
    // More would only repeat the same mistake.
    static constexpr size_t kMaxErrors = 10;

    void error(const StatementError& error) { errors_.push_back({error.position, error.message}); }
    void warning(Position position, std::string message) { warnings_.push_back({position, std::move(message)}); }
    bool full() const { return errors_.size() >= kMaxErrors; }
    bool failed() const { return !errors_.empty(); }
    // In the order of the file.
    std::vector<Diagnostic> errors() const;
    const std::vector<Diagnostic>& warnings() const { return warnings_; }

 private:
    std::vector<Diagnostic> errors_, warnings_;
};

// "file:line:column: message", as compilers print it, so that editors can jump there.
std::string located(std::string_view file, const Diagnostic& diagnostic);

// What was read, for a message: in backquotes, cut if long.
std::string quoted(std::string_view text);
// "a, b, c"
std::string listed(const std::vector<std::string_view>& words);
// "; did you mean `radius`?" for the word nearest to what was read, or nothing if none is near. Optimal string alignment
// distance (insertions, deletions, substitutions, swapped neighbours), letters compared without case.
std::string suggestion(std::string_view read, const std::vector<std::string_view>& words);

}  // namespace scene_format
