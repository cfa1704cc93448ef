#include "picture/overflow_counter.hpp"

#include "base/log.hpp"

namespace clarity {

void OverflowCounter::bind(KernelArguments& kernel) const {
    if (kernel.has("overflows")) kernel.set("overflows", count_.get());
}

void OverflowCounter::clear(Queue& queue) {
    const cl::Buffer& count = count_.fit(queue.getInfo<CL_QUEUE_CONTEXT>(), sizeof(cl_uint));
    queue.enqueueFillBuffer(count, cl_uint(0), 0, sizeof(cl_uint));
}

uint64_t OverflowCounter::read(Queue& queue) const {
    cl_uint count = 0;
    queue.enqueueReadBuffer(count_.get(), CL_TRUE, 0, sizeof count, &count);
    return count;
}

void report_overflows(uint64_t count, const std::string& accel) {
    if (count > 0)
        log(LogLevel::error,
            std::to_string(count) + " times a traversal stack was full: a fault of accel " + accel + "; hits may be missing");
}

}  // namespace clarity
