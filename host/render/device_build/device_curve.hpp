// device_curve.hpp -- the order of boxes along a Morton curve, on a device.
#pragma once
#include "render/device_build/device_reduce.hpp"
#include "render/device_build/device_sort.hpp"

namespace clarity {

class DeviceCurve {
 public:
    // For up to `most` boxes. A code has axis_bits (1 to 21) bits for each axis, in cubic cells that hold the centres of all
    // boxes. `kernels` must outlive this object.
    DeviceCurve(const BuildKernels& kernels, uint64_t most, unsigned axis_bits);

    // Writes the codes of `count` boxes (rt_prim), ascending, to keys (ulong), and the numbers of the boxes in this order to
    // `order` (uint); equal codes keep the order of the boxes. Only enqueues.
    void run(const cl::Buffer& boxes, uint64_t count, const cl::Buffer& keys, const cl::Buffer& order);

    uint64_t bytes() const { return reduce_.bytes() + sort_.bytes(); }

 private:
    const BuildKernels& kernels_;
    const unsigned axis_bits_;
    DeviceReduce reduce_;
    DeviceSort sort_;
    cl::Kernel codes_;
};

}  // namespace clarity
