// error.hpp -- the one exception type of the host. It carries the program's exit code.
#pragma once
#include <cstdint>
#include <stdexcept>
#include <string>

namespace clarity {

// Exit codes of the program. Users rely on them (docs and scripts), so they do not change.
enum class Exit {
    done = 0,
    failed = 1,
    usage = 2,
    no_device = 3,
    import_failed = 4,
    kernel_build_failed = 5,
    interrupted = 130
};

// A position in a text file, and what is wrong there.
struct SourceLocation {
    std::string file;               // path, or a name if the text was not read from disk; empty: the position is not known
    unsigned line = 0, column = 0;  // both count from 1; column 0: not known
    std::string message;            // "use of undeclared identifier 'x'"
};

// What kind of failure an Error or a Problem is, where code decides by it. Messages are for people alone.
enum class Failure : uint8_t {
    other,
    no_memory,     // memory was refused
    no_reason,     // a plugin failed and did not say why
    plugin_fault,  // a plugin broke its contract
    keeps_state,   // another result for the same input
    no_importer,   // for this kind of file
    builder,       // of a structure, while a picture is prepared
    crash,         // the last three are of a worker process
    exit,
    endless
};
constexpr Failure kLastFailure = Failure::endless;

// A failure which a person reads. The message says what was tried, on which file or device, why it failed and what to do.
class Error : public std::runtime_error {
 public:
    Error(Exit code, const std::string& message, std::string details = {}, SourceLocation location = {})
        : std::runtime_error(message), code_(code), details_(std::move(details)), location_(std::move(location)) {}
    // The same error, as one of a kind.
    Error as(Failure failure) const {
        Error error = *this;
        error.failure_ = failure;
        return error;
    }
    Exit code() const { return code_; }
    Failure failure() const { return failure_; }
    // Text of several lines, such as a compiler's log. May be empty.
    const std::string& details() const { return details_; }
    // Position of the error in the author's file; of several, the first.
    const SourceLocation& location() const { return location_; }

 private:
    Exit code_;
    std::string details_;
    SourceLocation location_;
    Failure failure_ = Failure::other;
};

// Thrown where work stopped because Progress::cancelled() is true.
struct Cancelled : Error {
    Cancelled() : Error(Exit::interrupted, "cancelled") {}
};

}  // namespace clarity
