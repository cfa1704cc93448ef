// device_blocks.hpp -- the boxes of neighbouring primitives on a device: cl/build/blocks.h.
#pragma once
#include "structures/on_device/build_kernels.hpp"

namespace clarity {

class DeviceBlocks {
 public:
    // Where the box of all primitives goes: an rt_block, and its six numbers.
    struct Whole {
        cl::Buffer block;
        cl_uint at = 0;  // index of the rt_block
        cl::Buffer bounds;
    };

    // `kernels` must outlive this object.
    explicit DeviceBlocks(const BuildKernels& kernels);

    static constexpr uint64_t kBytes = 32;  // of a block
    static constexpr uint64_t kTile = 256;  // RT_BLOCK_TILE: primitives whose blocks one work-group makes
    // Bytes of the blocks of `count` boxes.
    static uint64_t bytes(uint64_t count) { return kBytes * (2 * count + 64); }

    // Writes the blocks of `count` boxes (rt_prim) to `result`. order: which box stands at each place; nullptr: as they are.
    // Only enqueues.
    void run(const cl::Buffer& boxes, const cl::Buffer* order, uint64_t count, const cl::Buffer& result);
    // Writes those above the nine smallest sizes, which are there.
    void run_above(uint64_t count, const cl::Buffer& result, const Whole& whole);

 private:
    const BuildKernels& kernels_;
    cl::Kernel make_, larger_;
    Whole unused_;
};

}  // namespace clarity
