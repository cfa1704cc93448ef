// overflow_counter.hpp -- counts full traversal stacks in debug programs whose kernels have no counters of their own.
#pragma once
#include <cstdint>
#include <string>

#include "render/film/growing_buffer.hpp"

namespace clarity {

// One number on the device. Such kernels take it as the argument before the context, and only debug programs have it
// (RT_OVERFLOWS_PARAM in cl/lanes/rays.h). The caller handles cl::Error.
class OverflowCounter {
 public:
    // Sets argument `at` where the program is a debug program. Returns the number of the argument that follows.
    cl_uint bind(cl::Kernel& kernel, cl_uint at, bool debug);
    // Enqueues setting it to zero.
    void clear(cl::CommandQueue& queue);
    // Waits for all that is queued, and returns how many stacks were full since clear().
    uint64_t read(cl::CommandQueue& queue) const;

 private:
    GrowingBuffer count_{CL_MEM_READ_WRITE};
};

// Logs an error that names the structure, unless the count is 0.
void report_overflows(uint64_t count, const std::string& accel);

}  // namespace clarity
