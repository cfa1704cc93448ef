// kernel_time.hpp -- a time by the device's clock.
#pragma once
#include <string>

namespace clarity {

// The time of one step of a frame's work, measured by the device's clock.
struct KernelTime {
    std::string name;
    double ms = 0;
};

}  // namespace clarity
