// interrupt.hpp -- Ctrl-C and SIGTERM cancel the work at its next safe point, so that finished parts can be written. If no such
// point comes within kStopSeconds, because a driver is in the middle of a compilation or of a launch that cannot be stopped,
// the program ends where it is. A second signal ends the program at once.
#pragma once
#include <string>

#include "base/progress.hpp"

namespace clarity {

inline constexpr double kStopSeconds = 0.8;

// SIGINT and SIGTERM cancel `progress` during the lifetime of this object. Only one such object may exist at a time.
class CancelOnSignal {
 public:
    explicit CancelOnSignal(Progress& progress);
    ~CancelOnSignal();
    CancelOnSignal(const CancelOnSignal&) = delete;
    CancelOnSignal& operator=(const CancelOnSignal&) = delete;
};

// True if such a signal has come since the program started.
bool interrupted();

// The safe point is reached: what follows ends by itself, such as the writing of a large picture, and may take its time. Call
// it before finished parts are written. Without a signal it does nothing.
void take_time_to_stop();

// What is printed if the program has to end where it is, instead of a text about drivers. At most 500 bytes of it. "": nothing.
void say_at_deadline(const std::string& text);

}  // namespace clarity
