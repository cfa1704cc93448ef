// device_scan.hpp -- exclusive prefix sums on a device.
#pragma once
#include <vector>

#include "render/device_build/build_kernels.hpp"

namespace clarity {

class DeviceScan {
 public:
    // For up to `most` numbers. Takes all memory that it needs. `kernels` must outlive this object.
    DeviceScan(const BuildKernels& kernels, uint64_t most);

    // Replaces the first `count` numbers (uint) of `data` by the sums of those before them, modulo 2^32. Only enqueues.
    void run(const cl::Buffer& data, uint64_t count);

    uint64_t bytes() const { return bytes_; }

 private:
    // One level: the sums of the work-groups of the level below.
    struct Level {
        cl::Buffer sums;
        cl::Kernel sum, tiles;
    };
    void scan(const cl::Buffer& data, uint64_t count, size_t level);
    uint64_t tiles_each(uint64_t count) const;
    uint64_t groups_for(uint64_t count) const;

    const BuildKernels& kernels_;
    const uint64_t most_;
    std::vector<Level> levels_;
    uint64_t bytes_ = 0;
};

}  // namespace clarity
