// pinned_memory_pool.hpp -- host memory that a device can write to directly.
#pragma once
#include <CL/opencl.hpp>
#include <memory>

#include "device/device.hpp"

namespace clarity {

// A GPU copies into pinned memory at 55 GB/s over PCIe 5. Into other memory it copies at 10 to 20 GB/s, because the driver
// copies a second time while the caller waits. Pinning takes milliseconds, so returned memory is lent again. A CPU can write to
// any memory. It gets unpinned memory, which does not keep the device's context open.
class PinnedMemoryPool {
 public:
    explicit PinnedMemoryPool(std::shared_ptr<Device> device);  // nullptr: unpinned memory, as for a CPU
    // Returns at least `bytes` bytes with undefined content. The memory returns to the pool with its last copy, on any thread.
    // It may outlive the pool.
    std::shared_ptr<uint8_t> lend(size_t bytes);

 private:
    struct Block;
    struct Shelf;
    std::unique_ptr<Block> make(size_t bytes);

    std::shared_ptr<Device> device_;
    std::shared_ptr<Shelf> shelf_;  // blocks that are not lent
};

}  // namespace clarity
