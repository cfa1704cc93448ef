// device_sort.hpp -- sorts (key, value) pairs on a device: stable, by the low bits of the keys.
#pragma once
#include "render/device_build/device_scan.hpp"

namespace clarity {

enum class SortKeys { bits32, bits64 };

class DeviceSort {
 public:
    // For up to `most` pairs. Takes all memory that it needs: 8 or 12 bytes a pair, and counts. `kernels` must outlive this
    // object.
    DeviceSort(const BuildKernels& kernels, uint64_t most, SortKeys keys);

    // Sorts the first `count` keys (uint or ulong) and values (uint) by the lowest `bits` bits of the keys; higher bits are
    // ignored. Pairs with equal bits keep their order. Only enqueues. bits: 1 to 32 or 64.
    void run(const cl::Buffer& keys, const cl::Buffer& values, uint64_t count, unsigned bits);

    uint64_t bytes() const { return bytes_; }

 private:
    struct Digit {
        cl_uint shift, mask;
    };
    void start(cl::Kernel& kernel, const cl::Buffer& keys, uint64_t count, Digit digit, uint64_t tiles);
    void move(const cl::Buffer (&from)[2], const cl::Buffer (&to)[2], uint64_t count, Digit digit, bool few, unsigned pass,
              Digit next);
    uint64_t tiles_for(uint64_t count) const;

    const BuildKernels& kernels_;
    const uint64_t most_;
    const unsigned key_bytes_;
    cl::Kernel count_, count_few_, move_;
    cl::Buffer keys_, values_, counts_;
    DeviceScan scan_;
    uint64_t bytes_ = 0;
};

}  // namespace clarity
