// diagnostics.hpp -- collects the errors and warnings of one scene file, each with its line and column.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace scene_format {

// Line and column count from 1. A column is one character (UTF-8 code point); a tab counts as one.
struct Position {
    uint32_t line = 0, column = 0;
};

// Thrown for a statement that cannot be understood. The parser records it and continues with the next line.
struct StatementError {
    Position position;
    std::string message;
    bool ends_reading = false;  // true: the parser stops, because errors in the rest of the file would tell nothing
};

struct Diagnostic {
    Position position;
    std::string message;
};

class Diagnostics {
 public:
    // Parsing stops after this many errors, because more would usually repeat the same mistake.
    static constexpr size_t kMaxErrors = 10;

    void error(const StatementError& error) { errors_.push_back({error.position, error.message}); }
    void warning(Position position, std::string message) { warnings_.push_back({position, std::move(message)}); }
    bool full() const { return errors_.size() >= kMaxErrors; }
    bool failed() const { return !errors_.empty(); }
    // Returns the errors in the order of the file.
    std::vector<Diagnostic> errors() const;
    const std::vector<Diagnostic>& warnings() const { return warnings_; }

 private:
    std::vector<Diagnostic> errors_, warnings_;
};

// Formats "file:line:column: message". Compilers print errors like this, so editors can jump to the place.
std::string located(std::string_view file, const Diagnostic& diagnostic);

// Returns the text in backquotes for a message, cut if it is long.
std::string in_quotes(std::string_view text);
// Joins the words: "a, b, c".
std::string listed(const std::vector<std::string_view>& words);
// Returns "; did you mean `radius`?" with the word nearest to what was read, or nothing if no word is near. The distance is the
// optimal string alignment distance (insertions, deletions, substitutions, swapped neighbours), without regard to case.
std::string suggestion(std::string_view read, const std::vector<std::string_view>& words);

}  // namespace scene_format
