// elapsed.hpp -- time by a clock, and time of processors.
#pragma once
#include <chrono>
#include <ctime>

namespace clarity {

inline double ms_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Seconds of the steady clock, since some moment in the past.
inline double now_s() {
    return seconds_since({});
}

// Time that processors spent on this process: on a busy machine it is steadier than time by a clock.

// Of all threads of this process, in ms.
inline double processor_ms() {
    timespec used{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    return 1e3 * double(used.tv_sec) + 1e-6 * double(used.tv_nsec);
}

}  // namespace clarity
