// device_reduce.hpp -- the bounds of boxes, and of their centres, on a device.
#pragma once
#include "render/device_build/build_kernels.hpp"

namespace clarity {

// What a reduction leaves in its result buffer: rt_build_bounds of reduce.cl. Without boxes: lo = +inf, hi = -inf.
struct DeviceBounds {
    float lo[3], least_centre[3], hi[3], greatest_centre[3];
};

class DeviceReduce {
 public:
    // `kernels` must outlive this object.
    explicit DeviceReduce(const BuildKernels& kernels);

    // Writes the bounds of boxes[first] to boxes[first + count - 1] (rt_prim) to `result`, a DeviceBounds. Only enqueues.
    void run(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& result);

    uint64_t bytes() const { return bytes_; }

 private:
    const BuildKernels& kernels_;
    const uint64_t most_groups_;
    cl::Kernel boxes_, parts_;
    cl::Buffer bounds_;
    uint64_t bytes_ = 0;
};

}  // namespace clarity
