// overflow_counter.hpp -- counts full traversal stacks in debug programs that have no ray counters.
#pragma once
#include <cstdint>
#include <string>

#include "device/growing_buffer.hpp"
#include "device/queue.hpp"
#include "kernels/kernel_arguments.hpp"

namespace clarity {

// One number on the device. Debug programs of these kernels take it as the argument `overflows` (RT_OVERFLOWS_PARAM in
// cl/lanes/rays.h). The functions throw cl::Error, which the caller handles.
class OverflowCounter {
 public:
    // Sets the argument if the kernel has it. Call clear() before.
    void bind(KernelArguments& kernel) const;
    // Enqueues a reset to zero.
    void clear(Queue& queue);
    // Waits for all queued commands and returns how many stacks were full since clear().
    uint64_t read(Queue& queue) const;

 private:
    GrowingBuffer count_{CL_MEM_READ_WRITE};
};

// Logs an error that names the structure if the count is not 0.
void report_overflows(uint64_t count, const std::string& accel);

}  // namespace clarity
