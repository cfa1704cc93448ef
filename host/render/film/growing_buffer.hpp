// growing_buffer.hpp -- device memory whose content need not outlive a change of size.
#pragma once
#include <CL/opencl.hpp>

namespace clarity {

class GrowingBuffer {
 public:
    explicit GrowingBuffer(cl_mem_flags flags) : flags_(flags) {}
    // At least so many bytes; what was in it is lost if they are more than before. Never empty: no device takes that.
    const cl::Buffer& fit(const cl::Context& context, size_t bytes);
    const cl::Buffer& get() const { return buffer_; }

 private:
    cl_mem_flags flags_;
    cl::Buffer buffer_;
    size_t bytes_ = 0;
};

}  // namespace clarity
