// growing_buffer.hpp -- a device buffer that grows on demand and then loses its content.
#pragma once
#include <CL/opencl.hpp>

namespace clarity {

// Used from one thread.
class GrowingBuffer {
 public:
    explicit GrowingBuffer(cl_mem_flags flags) : flags_(flags) {}
    // Returns a buffer of at least `bytes`, and at least 256, since OpenCL does not allow empty buffers. If the buffer must
    // grow, its content is lost. Throws cl::Error.
    const cl::Buffer& fit(const cl::Context& context, size_t bytes);
    const cl::Buffer& get() const { return buffer_; }

 private:
    cl_mem_flags flags_;
    cl::Buffer buffer_;
    size_t bytes_ = 0;
};

}  // namespace clarity
