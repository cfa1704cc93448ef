// timeline.hpp -- records what the program does and when, as a file in Chrome's trace format (`--trace FILE`), which Perfetto
// and chrome://tracing show.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include "base/elapsed.hpp"

namespace clarity::timeline {

// A span on a track. Times are microseconds of the steady clock. `bytes`: 0 if it moves none.
struct Span {
    std::string name;
    const char* kind = "";  // "import", "build", "compile", "launch", "copy", ...
    double begin_us = 0, end_us = 0;
    uint64_t bytes = 0;
};

namespace detail {
extern std::atomic<bool> recording;
}
inline bool recording() {
    return detail::recording.load(std::memory_order_relaxed);
}

// Starts to record. Throws Error if the file cannot be written. For one call, before other threads start.
void record(const std::string& path);
// Writes the file, if one is recorded, and ends the recording. Throws Error if it cannot be written; then there is no file.
void write();

inline double now_us() {
    return 1e6 * now_s();
}
// Adds a span to the track of the calling thread, or to a named one. Thread-safe. Beyond a million spans they are only counted.
void add(Span span);
void add(const std::string& track, Span span);
// Has `more` called by write(), to add what is known only then. It must not wait.
void before_writing(std::function<void()> more);
// Says at the end that `count` more spans are left out.
void leave_out(size_t count);
// A text, or what a function makes.
template <class Name>
std::string text_of(const Name& name) {
    if constexpr (std::is_invocable_v<Name>)
        return name();
    else
        return name;
}

// A span from its construction to its end. Costs a load where nothing is recorded. `name` is a text, or a function that makes
// it.
class Scope {
 public:
    template <class Name>
    Scope(const char* kind, const Name& name) {
        if (!recording()) return;
        span_.name = text_of(name);
        span_.kind = kind;
        span_.begin_us = now_us();
        open_ = true;
    }
    ~Scope() {
        if (!open_) return;
        span_.end_us = now_us();
        add(std::move(span_));
    }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

 private:
    Span span_;
    bool open_ = false;
};

}  // namespace clarity::timeline
