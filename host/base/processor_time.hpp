// processor_time.hpp -- time that processors spent on this process: on a busy machine it is steadier than time by a clock.
#pragma once
#include <ctime>

namespace clarity {

// Of all threads of this process, in ms.
inline double processor_ms() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return 1e3 * double(used.tv_sec) + 1e-6 * double(used.tv_nsec);
}

}  // namespace clarity
