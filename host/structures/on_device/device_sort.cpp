#include "structures/on_device/device_sort.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "device/kernel_files.hpp"

namespace clarity {
namespace {

constexpr unsigned kDigitBits = 8;  // of a pass, at most: RT_DIGITS of sort.cl
constexpr unsigned kPasses = 64 / kDigitBits;
// Sorts of no more pairs are one launch a pass. Their tiles are smaller, so that more work-groups share the work.
constexpr uint64_t kFewPairs = uint64_t{1} << 17;

unsigned passes_for(unsigned bits) {
    return (bits + kDigitBits - 1) / kDigitBits;
}

// One work-group takes so many tiles one after the other, before more groups and two more launches pay.
constexpr uint64_t kTilesOfOneGroup = 4;
// Work-groups of a CPU's unit. More of them balance the load, fewer leave less to do for the next level.
constexpr uint64_t kGroupsPerCpuUnit = 8;

// Work-groups of a device's unit, so that its memory is busy.
constexpr uint64_t kGroupsPerUnit = 8;
constexpr uint64_t kLeastBoxes = 512;  // of a work-group

constexpr uint64_t kSerialBoxes = 4096;  // that a work-group of one work-item takes

}  // namespace

DeviceSort::DeviceSort(const BuildKernels& kernels, uint64_t most, SortKeys keys)
    : kernels_(kernels),
      most_(most),
      key_bytes_(keys == SortKeys::bits32 ? 4 : 8),
      few_(!kernels.serial() && most <= kFewPairs),
      scan_(kernels, tiles_for(most) << kDigitBits) {
    const cl::Program program =
        kernels.compile_file("sort.cl", std::string("-DRT_KEY=") + (key_bytes_ == 4 ? "uint" : "ulong") +
                                            " -DRT_SORT_TILE=" + std::to_string(tile()) + "u");
    count_ = cl::Kernel(program, few_ ? "sort_count_few" : "sort_count");
    move_ = cl::Kernel(program, "sort_move");
    const uint64_t counts = 4 * tiles_for(most) * (few_ ? kPasses : 1) << kDigitBits;
    own_ = {kernels.buffer(key_bytes_ * most), kernels.buffer(4 * most)};
    counts_ = kernels.buffer(counts);
    bytes_ = (key_bytes_ + 4) * most + counts + scan_.bytes();
}

unsigned DeviceSort::tile() const {
    return kernels_.serial() ? 8192 : few_ ? 1024 : 2048;
}

uint64_t DeviceSort::tiles_for(uint64_t count) const {
    return (count + tile() - 1) / tile();
}

void DeviceSort::run(const cl::Buffer& keys, const cl::Buffer& values, uint64_t count, unsigned bits) {
    sort({keys, values}, own_, count, bits, (passes_for(bits) + 1) / 2 * 2);  // even: the result is in the caller's buffers
}

const DeviceSort::Pairs& DeviceSort::input(const Pairs& sorted, unsigned bits) const {
    return passes_for(bits) % 2 == 0 ? sorted : own_;
}

void DeviceSort::run_into(const Pairs& sorted, uint64_t count, unsigned bits) {
    const bool even = passes_for(bits) % 2 == 0;
    sort(even ? sorted : own_, even ? own_ : sorted, count, bits, passes_for(bits));
}

void DeviceSort::sort(const Pairs& from, const Pairs& other, uint64_t count, unsigned bits, unsigned passes) {
    if (count > most_ || bits == 0 || bits > 8 * key_bytes_)
        throw Error(Exit::failed, "a sort of " + std::to_string(count) + " pairs by " + std::to_string(bits) +
                                      " bits was asked for, with memory for " + std::to_string(most_) + " pairs of " +
                                      std::to_string(8 * key_bytes_) + " bits (a bug in the builder: please report it)");
    if (count == 0) return;
    const auto digit = [&](unsigned p) {
        const unsigned shift = bits * p / passes;
        return p < passes ? Digit{shift, (cl_uint{1} << (bits * (p + 1) / passes - shift)) - 1} : Digit{0, 0};
    };
    for (unsigned p = 0; p < passes; ++p) {
        const Pairs &now = p % 2 == 0 ? from : other, &then = p % 2 == 0 ? other : from;
        if (!few_ || p == 0) {
            count_.setArg(0, now.keys);
            count_.setArg(1, static_cast<cl_uint>(count));
            count_.setArg(2, digit(p).shift);
            count_.setArg(3, digit(p).mask);
            count_.setArg(4, counts_);
            if (few_) count_.setArg(5, cl_uint{passes});
            kernels_.launch(count_, tiles_for(count));
        }
        if (!few_) scan_.run(counts_, tiles_for(count) * (digit(p).mask + 1));
        move(now, then, count, digit(p), p, digit(p + 1));
    }
}

void DeviceSort::move(const Pairs& from, const Pairs& to, uint64_t count, Digit digit, unsigned pass, Digit next) {
    move_.setArg(0, from.keys);
    move_.setArg(1, from.values);
    move_.setArg(2, static_cast<cl_uint>(count));
    move_.setArg(3, digit.shift);
    move_.setArg(4, digit.mask);
    move_.setArg(5, counts_);
    move_.setArg(6, to.keys);
    move_.setArg(7, to.values);
    if (!kernels_.serial()) {
        move_.setArg(8, cl_uint{few_});
        move_.setArg(9, cl_uint{pass});
        move_.setArg(10, next.shift);
        move_.setArg(11, next.mask);
    }
    kernels_.launch(move_, tiles_for(count));
}

DeviceScan::DeviceScan(const BuildKernels& kernels, uint64_t most) : kernels_(kernels), most_(most) {
    const cl::Program program = kernels.compile_file("scan.cl");
    for (uint64_t count = most;; count = groups_for(count)) {
        const uint64_t sums = groups_for(count);
        levels_.push_back({kernels.buffer(4 * sums), cl::Kernel(program, "scan_sums"), cl::Kernel(program, "scan_tiles")});
        bytes_ += 4 * sums;
        if (sums == 1) break;
    }
}

uint64_t DeviceScan::tiles_each(uint64_t count) const {
    const uint64_t tiles = (count + kernels_.scan_tile() - 1) / kernels_.scan_tile();
    if (tiles <= kTilesOfOneGroup) return kTilesOfOneGroup;
    const uint64_t groups = uint64_t{kernels_.device().info().compute_units} * kGroupsPerCpuUnit;
    return kernels_.serial() ? (tiles + groups - 1) / groups : 1;
}

uint64_t DeviceScan::groups_for(uint64_t count) const {
    const uint64_t each = tiles_each(count) * kernels_.scan_tile();
    return std::max<uint64_t>((count + each - 1) / each, 1);
}

void DeviceScan::run(const cl::Buffer& data, uint64_t count) {
    if (count > most_)
        throw Error(Exit::failed, "a scan of " + std::to_string(count) + " numbers was asked for, with memory for " +
                                      std::to_string(most_) + " (a bug in the builder: please report it)");
    if (count > 0) scan(data, count, 0);
}

void DeviceScan::scan(const cl::Buffer& data, uint64_t count, size_t at) {
    Level& level = levels_[at];
    const uint64_t groups = groups_for(count);
    const auto numbers = static_cast<cl_uint>(count), each = static_cast<cl_uint>(tiles_each(count));
    if (groups > 1) {
        level.sum.setArg(0, data);
        level.sum.setArg(1, numbers);
        level.sum.setArg(2, each);
        level.sum.setArg(3, level.sums);
        kernels_.launch(level.sum, groups);
        scan(level.sums, groups, at + 1);
    }
    level.tiles.setArg(0, data);
    level.tiles.setArg(1, numbers);
    level.tiles.setArg(2, each);
    level.tiles.setArg(3, level.sums);
    level.tiles.setArg(4, cl_uint{groups > 1});
    kernels_.launch(level.tiles, groups);
}

DeviceReduce::DeviceReduce(const BuildKernels& kernels)
    : kernels_(kernels), most_groups_(std::max(1u, kernels.device().info().compute_units) * kGroupsPerUnit) {
    const cl::Program program = kernels.compile_file("reduce.cl");
    reduce_boxes_ = cl::Kernel(program, "reduce_boxes");
    reduce_parts_ = cl::Kernel(program, "reduce_parts");
    all_parts_ = kernels.buffer(most_groups_ * sizeof(DeviceBounds));
    parts_ = kernels.buffer(kFewParts * sizeof(DeviceBounds));
    bytes_ = (most_groups_ + kFewParts) * sizeof(DeviceBounds);
}

void DeviceReduce::run(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& result) {
    join(reduce(boxes, first, count, all_parts_), result);
}

uint64_t DeviceReduce::run_parts(const cl::Buffer& boxes, uint64_t first, uint64_t count) {
    if (groups_for(count) <= kFewParts) return reduce(boxes, first, count, parts_);
    run(boxes, first, count, parts_);
    return 1;
}

uint64_t DeviceReduce::groups_for(uint64_t count) const {
    const uint64_t each = std::max(kLeastBoxes, (count + most_groups_ - 1) / most_groups_);
    return std::max<uint64_t>((count + each - 1) / each, 1);
}

uint64_t DeviceReduce::reduce(const cl::Buffer& boxes, uint64_t first, uint64_t count, const cl::Buffer& parts) {
    const uint64_t groups = groups_for(count);
    reduce_boxes_.setArg(0, boxes);
    reduce_boxes_.setArg(1, static_cast<cl_uint>(first));
    reduce_boxes_.setArg(2, static_cast<cl_uint>(count));
    reduce_boxes_.setArg(3, static_cast<cl_uint>((count + groups - 1) / groups));
    reduce_boxes_.setArg(4, parts);
    kernels_.launch(reduce_boxes_, groups);
    return groups;
}

void DeviceReduce::join(uint64_t parts, const cl::Buffer& result) {
    reduce_parts_.setArg(0, all_parts_);
    reduce_parts_.setArg(1, static_cast<cl_uint>(parts));
    reduce_parts_.setArg(2, result);
    kernels_.launch(reduce_parts_, 1);
}

DeviceCurve::DeviceCurve(const BuildKernels& kernels, uint64_t most, unsigned axis_bits)
    : kernels_(kernels), axis_bits_(axis_bits), reduce_(kernels), sort_(kernels, most, SortKeys::bits64) {
    const cl::Program program = kernels.compile(
        kernel_text("build/reduce.cl") + "#line 1 \"cl/build/curve.cl\"\n" + kernel_text("build/curve.cl"), "build/curve.cl");
    codes_ = cl::Kernel(program, "curve_codes");
}

void DeviceCurve::run(const cl::Buffer& boxes, uint64_t count, const cl::Buffer& keys, const cl::Buffer& order) {
    if (count == 0) return;
    const uint64_t parts = reduce_.run_parts(boxes, 0, count), each = kernels_.serial() ? kSerialBoxes : kernels_.group();
    const DeviceSort::Pairs sorted = {keys, order}, unsorted = sort_.input(sorted, 3 * axis_bits_);
    codes_.setArg(0, boxes);
    codes_.setArg(1, static_cast<cl_uint>(count));
    codes_.setArg(2, static_cast<cl_uint>(each));
    codes_.setArg(3, cl_uint{axis_bits_});
    codes_.setArg(4, reduce_.parts());
    codes_.setArg(5, static_cast<cl_uint>(parts));
    codes_.setArg(6, unsorted.keys);
    codes_.setArg(7, unsorted.values);
    kernels_.launch(codes_, (count + each - 1) / each);
    sort_.run_into(sorted, count, 3 * axis_bits_);
}

}  // namespace clarity
