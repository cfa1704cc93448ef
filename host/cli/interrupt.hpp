// interrupt.hpp -- Ctrl-C cancels the work at its next safe point, so that finished parts can be written. A second Ctrl-C ends
// the program at once.
#pragma once
#include "base/progress.hpp"

namespace clarity {

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

}  // namespace clarity
