// device_sort.hpp -- what builders on a device are made of: prefix sums, sorts, bounds, and the order of boxes along a curve.
#pragma once
#include <vector>

#include "structures/on_device/build_kernels.hpp"

namespace clarity {

// Exclusive prefix sums on a device.
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

enum class SortKeys { bits32, bits64 };

// Sorts (key, value) pairs on a device: stable, by the low bits of the keys.
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

// The bounds of boxes, and of their centres: what a reduction leaves in its result buffer: rt_build_bounds of reduce.cl.
// Without boxes: lo = +inf, hi = -inf.
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

// The order of boxes along a Morton curve, on a device.
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
