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

    struct Pairs {
        cl::Buffer keys, values;
    };
    // The same with one pass less, if that is enough: the pairs are to be in input(), and the result is in `sorted`.
    void run_into(const Pairs& sorted, uint64_t count, unsigned bits);
    const Pairs& input(const Pairs& sorted, unsigned bits) const;

    uint64_t bytes() const { return bytes_; }

 private:
    struct Digit {
        cl_uint shift, mask;
    };
    void start(cl::Kernel& kernel, const cl::Buffer& keys, uint64_t count, Digit digit, uint64_t tiles);
    void sort(const Pairs& from, const Pairs& other, uint64_t count, unsigned bits, unsigned passes);
    void move(const Pairs& from, const Pairs& to, uint64_t count, Digit digit, unsigned pass, Digit next);
    uint64_t tiles_for(uint64_t count) const;
    unsigned tile() const;

    const BuildKernels& kernels_;
    const uint64_t most_;
    const unsigned key_bytes_;
    const bool few_;  // tiles
    cl::Kernel count_, count_few_, move_;
    Pairs own_;
    cl::Buffer counts_;
    DeviceScan scan_;
    uint64_t bytes_ = 0;
};

}  // namespace clarity
