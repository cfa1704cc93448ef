// pinned_memory_pool.hpp -- memory of the host that a device writes to without a detour.
#pragma once
#include <CL/opencl.hpp>
#include <memory>

#include "device/device.hpp"

namespace clarity {

// A GPU copies into pinned memory at 55 GB/s over PCIe 5, into any other at 10 to 20: the driver then copies once more, and who
// asks for it waits. To pin takes milliseconds, so memory that comes back is lent again. A CPU writes to any memory, and gets
// plain one, which does not keep its context open.
class PinnedMemoryPool {
 public:
    explicit PinnedMemoryPool(std::shared_ptr<Device> device);  // nullptr: as for a CPU
    // So many bytes at least, with anything in them. They come back with the last copy, of whatever thread, and may outlive
    // this.
    std::shared_ptr<uint8_t> lend(size_t bytes);

 private:
    struct Block;
    struct Shelf;
    std::unique_ptr<Block> make(size_t bytes);

    std::shared_ptr<Device> device_;
    std::shared_ptr<Shelf> shelf_;  // what is not lent
};

}  // namespace clarity
