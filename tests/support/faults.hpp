// faults.hpp -- a device that has no room left, refuses work or is slow: entry points that come before the driver's in programs
// that link this.
#pragma once
#include <atomic>
#include <cstddef>

namespace clarity::test {

struct Faults {
    std::atomic<size_t> largest_buffer{~size_t(0)};
    std::atomic<int> launches_left{-1}, copies_left{-1};  // negative: no end of them
    std::atomic<unsigned> copy_ms{0};                     // that a copy nobody waits for takes longer
    void end();
};
extern Faults faults;

}  // namespace clarity::test
