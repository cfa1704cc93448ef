// elapsed.hpp -- elapsed time in milliseconds and in seconds.
#pragma once
#include <chrono>

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

}  // namespace clarity
