// device_curve.hpp -- the places of boxes on a Morton curve, on a device.
#pragma once
#include "render/device_build/device_reduce.hpp"

namespace clarity {

class DeviceCurve {
 public:
    // `kernels` must outlive this object.
    explicit DeviceCurve(const BuildKernels& kernels);

    // Writes the codes of the centres of `count` boxes (rt_prim) to keys (ulong), and 0, 1, 2, ... to values (uint). A code has
    // axis_bits bits for each axis, in cubic cells that hold all centres. Only enqueues. axis_bits: 1 to 21.
    void run(const cl::Buffer& boxes, uint64_t count, unsigned axis_bits, const cl::Buffer& keys, const cl::Buffer& values);

    uint64_t bytes() const { return reduce_.bytes(); }

 private:
    const BuildKernels& kernels_;
    DeviceReduce reduce_;
    cl::Kernel codes_;
};

}  // namespace clarity
