// clock.hpp -- what tests ask of the clock. A busy machine makes any bound on a time wrong. So tests wait for states, as long
// as for something that hangs, and bounds on times count in the step `clocks` of scripts/full_test alone, which runs them one
// by one on an idle machine. Tests that include this file are those of that step (tests/CMakeLists.txt);
// tests/scripts/clocks_test.sh finds tests that ask a clock in another way.
#pragma once
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace clarity::test {

inline constexpr double kHangs_s = 900;  // what has not come by then never does

inline double seconds_since(std::chrono::steady_clock::time_point begin) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// Whether times are judged.
inline bool clocks_count() {
    return std::getenv("CLARITY_TEST_CLOCKS") != nullptr;
}

// The bound on something that takes `seconds` at most on an idle machine.
inline double at_most(double seconds) {
    return clocks_count() ? seconds : std::max(seconds, kHangs_s);
}

// Waits for a state. Returns false if it does not come.
template <class Condition>
bool comes(const Condition& condition, double seconds = kHangs_s) {
    for (const auto begin = std::chrono::steady_clock::now(); !condition();) {
        if (seconds_since(begin) > seconds) return false;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return true;
}

}  // namespace clarity::test
