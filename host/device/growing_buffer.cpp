#include "device/growing_buffer.hpp"

#include <algorithm>
#include <memory>
#include <new>

#include "base/aligned_bytes.hpp"

namespace clarity {
namespace {

constexpr size_t kLarge = 1u << 20;

bool is_cpu(const cl::Context& context) {
    const auto devices = context.getInfo<CL_CONTEXT_DEVICES>();
    return !devices.empty() && devices[0].getInfo<CL_DEVICE_TYPE>() == CL_DEVICE_TYPE_CPU;
}

// Large buffers of a CPU are host memory in large pages, which is freed when the device has released the buffer. A driver's own
// memory has small pages. Views with few hits mostly read rays and write hits or pixels, and spent a seventh of their time on
// page-table look-ups.
cl::Buffer make_buffer(const cl::Context& context, cl_mem_flags flags, size_t bytes) {
    if (bytes < kLarge || !is_cpu(context)) return {context, flags, bytes};
    std::unique_ptr<AlignedBytes> memory;
    try {
        memory = std::make_unique<AlignedBytes>(bytes, false);
    } catch (const std::bad_alloc&) {  // the driver reports this better
        return {context, flags, bytes};
    }
    flags = (flags & ~cl_mem_flags{CL_MEM_ALLOC_HOST_PTR}) | CL_MEM_USE_HOST_PTR;
    cl::Buffer buffer(context, flags, bytes, memory->data());
    buffer.setDestructorCallback([](cl_mem, void* data) { delete static_cast<AlignedBytes*>(data); }, memory.get());
    static_cast<void>(memory.release());  // the callback deletes it
    return buffer;
}

}  // namespace

const cl::Buffer& GrowingBuffer::fit(const cl::Context& context, size_t bytes) {
    bytes = std::max<size_t>(bytes, 256);
    if (bytes > bytes_) {
        buffer_ = cl::Buffer();  // first, so that both buffers need not fit at the same time
        bytes_ = 0;
        buffer_ = make_buffer(context, flags_, bytes);
        bytes_ = bytes;
    }
    return buffer_;
}

}  // namespace clarity
