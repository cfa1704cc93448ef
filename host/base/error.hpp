// error.hpp -- how the host fails: one exception type that carries the program's exit code.
#pragma once
#include <stdexcept>
#include <string>

namespace clarity {

// Exit codes of the program, part of its contract.
enum class Exit {
    done = 0,
    failed = 1,
    usage = 2,
    no_device = 3,
    import_failed = 4,
    kernel_build_failed = 5,
    interrupted = 130
};

// A place in a text file, and what is wrong there.
struct SourceLocation {
    std::string file;               // a path, if the text was read from disk; empty: no place is known
    unsigned line = 0, column = 0;  // from 1; column 0: not known
    std::string message;            // "use of undeclared identifier 'x'"
};

// A failure that a person reads: what was tried, on which file or device, why it failed and what to do.
class Error : public std::runtime_error {
 public:
    Error(Exit code, const std::string& message, std::string details = {}, SourceLocation location = {})
        : std::runtime_error(message), code_(code), details_(std::move(details)), location_(std::move(location)) {}
    Exit code() const { return code_; }
    // More than a line: a compiler's log, say. May be empty.
    const std::string& details() const { return details_; }
    // Where an author has to look; the first place of several.
    const SourceLocation& location() const { return location_; }

 private:
    Exit code_;
    std::string details_;
    SourceLocation location_;
};

// Thrown where work stopped because Progress said so.
struct Cancelled : Error {
    Cancelled() : Error(Exit::interrupted, "cancelled") {}
};

}  // namespace clarity
