// device_blocks.hpp -- the boxes of neighbouring primitives on a device: cl/build/blocks.h.
#pragma once
#include "render/device_build/build_kernels.hpp"

namespace clarity {

class DeviceBlocks {
 public:
    // `kernels` must outlive this object.
    explicit DeviceBlocks(const BuildKernels& kernels);

    // Bytes of the blocks of `count` boxes.
    static uint64_t bytes(uint64_t count) { return 24 * (2 * count + 64); }

    // Writes the blocks of `count` boxes (rt_prim) to `result`. order: which box stands at each place; nullptr: as they are.
    // Only enqueues.
    void run(const cl::Buffer& boxes, const cl::Buffer* order, uint64_t count, const cl::Buffer& result);

 private:
    const BuildKernels& kernels_;
    cl::Kernel make_;
};

}  // namespace clarity
