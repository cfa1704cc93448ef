// faults.hpp -- simulates a device that has no memory left, refuses work or is slow. Programs that link this call its OpenCL
// functions instead of the driver's.
#pragma once
#include <atomic>
#include <cstddef>

namespace clarity::test {

// Settings of all later OpenCL calls. end() restores the normal state.
struct Faults {
    // In bytes; larger buffers cannot be allocated.
    std::atomic<size_t> largest_buffer{~size_t(0)};
    std::atomic<int> launches_left{-1}, copies_left{-1};  // calls until they fail; negative: they never fail
    std::atomic<unsigned> copy_ms{0};                     // additional time of asynchronous reads
    void end();
};
extern Faults faults;

}  // namespace clarity::test
