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

    // The same, but `parts()` receives the bounds of parts of the boxes. Returns how many: at most kFewParts.
    uint64_t run_parts(const cl::Buffer& boxes, uint64_t first, uint64_t count);
    static constexpr uint64_t kFewParts = 256;
    const cl::Buffer& parts() const { return parts_; }

    uint64_t bytes() const { return bytes_; }

 private:
    uint64_t reduce(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& parts);
    void join(uint64_t parts, const cl::Buffer& result);
    uint64_t groups_for(uint64_t count) const;

    const BuildKernels& kernels_;
    const uint64_t most_groups_;
    cl::Kernel reduce_boxes_, reduce_parts_;
    cl::Buffer all_parts_, parts_;
    uint64_t bytes_ = 0;
};

}  // namespace clarity
