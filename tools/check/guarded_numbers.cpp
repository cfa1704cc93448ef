#include "tools/check/guarded_numbers.hpp"

#include <algorithm>
#include <cstring>

namespace clarity::check {

namespace {

constexpr size_t kAlignment = 16;  // of `more`, as CONTRACT.md says

}  // namespace

std::shared_ptr<const GuardedBytes> guarded_numbers(const float* numbers, size_t count, const char* name) {
    GuardedBytes bytes(std::max<size_t>(count, 4) * sizeof(float), name, kAlignment);
    if (count > 0) std::memcpy(bytes.data(), numbers, count * sizeof(float));
    bytes.make_read_only();
    return std::make_shared<const GuardedBytes>(std::move(bytes));
}

cl::Buffer guarded_buffer(Device& device, const GuardedBytes& bytes) {
    const cl_mem_flags how = device.info().cpu ? CL_MEM_USE_HOST_PTR : CL_MEM_COPY_HOST_PTR;
    return cl::Buffer(device.context(), CL_MEM_READ_ONLY | how, bytes.bytes(), const_cast<void*>(bytes.data()));
}

}  // namespace clarity::check
