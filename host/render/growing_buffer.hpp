// growing_buffer.hpp -- device memory whose content need not outlive a change of size.
#pragma once
#include <CL/opencl.hpp>
#include <algorithm>

namespace clarity {

class GrowingBuffer {
 public:
    explicit GrowingBuffer(cl_mem_flags flags) : flags_(flags) {}
    // At least so many bytes; what was in it is lost if they are more than before. Never empty: no device takes that.
    const cl::Buffer& fit(const cl::Context& context, size_t bytes) {
        bytes = std::max<size_t>(bytes, 256);
        if (bytes > bytes_) {
            buffer_ = cl::Buffer();  // first, so that both need not fit at once
            bytes_ = 0;
            buffer_ = cl::Buffer(context, flags_, bytes);
            bytes_ = bytes;
        }
        return buffer_;
    }
    const cl::Buffer& get() const { return buffer_; }

 private:
    cl_mem_flags flags_;
    cl::Buffer buffer_;
    size_t bytes_ = 0;
};

}  // namespace clarity
