// interrupt.hpp -- Ctrl-C ends work at its next safe point, so that what is finished can be written; a second one ends at once.
#pragma once
#include "base/progress.hpp"

namespace clarity {

// While it lives, SIGINT and SIGTERM cancel `progress`. One at a time.
class CancelOnSignal {
 public:
    explicit CancelOnSignal(Progress& progress);
    ~CancelOnSignal();
    CancelOnSignal(const CancelOnSignal&) = delete;
    CancelOnSignal& operator=(const CancelOnSignal&) = delete;
};

// Whether such a signal came since the program began.
bool interrupted();

}  // namespace clarity
