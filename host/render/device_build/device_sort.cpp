#include "render/device_build/device_sort.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr unsigned kDigitBits = 8;  // of a pass, at most: RT_DIGITS of sort.cl
constexpr unsigned kPasses = 64 / kDigitBits;
constexpr uint64_t kFewTiles = 128;  // a pass over no more of them is one launch

}  // namespace

DeviceSort::DeviceSort(const BuildKernels& kernels, uint64_t most, SortKeys keys)
    : kernels_(kernels),
      most_(most),
      key_bytes_(keys == SortKeys::bits32 ? 4 : 8),
      scan_(kernels, tiles_for(most) << kDigitBits) {
    const cl::Program program = kernels.compile_file("sort.cl", key_bytes_ == 4 ? "-DRT_KEY=uint" : "-DRT_KEY=ulong");
    count_ = cl::Kernel(program, "sort_count");
    move_ = cl::Kernel(program, "sort_move");
    if (!kernels.serial()) count_few_ = cl::Kernel(program, "sort_count_few");
    const uint64_t tables = std::max(tiles_for(most), kPasses * std::min(tiles_for(most), kFewTiles));
    const uint64_t counts = 4 * tables << kDigitBits;
    keys_ = kernels.buffer(key_bytes_ * most);
    values_ = kernels.buffer(4 * most);
    counts_ = kernels.buffer(counts);
    bytes_ = (key_bytes_ + 4) * most + counts + scan_.bytes();
}

uint64_t DeviceSort::tiles_for(uint64_t count) const {
    return (count + kernels_.sort_tile() - 1) / kernels_.sort_tile();
}

void DeviceSort::run(const cl::Buffer& keys, const cl::Buffer& values, uint64_t count, unsigned bits) {
    if (count > most_ || bits == 0 || bits > 8 * key_bytes_)
        throw Error(Exit::failed, "a sort of " + std::to_string(count) + " pairs by " + std::to_string(bits) +
                                      " bits was asked for, with memory for " + std::to_string(most_) + " pairs of " +
                                      std::to_string(8 * key_bytes_) + " bits (a bug in the builder: please report it)");
    if (count < 2) return;
    // An even number of passes, so that the result is in the caller's buffers.
    const unsigned passes = (bits + 2 * kDigitBits - 1) / (2 * kDigitBits) * 2;
    const cl::Buffer theirs[2] = {keys, values}, ours[2] = {keys_, values_};
    const auto digit = [&](unsigned p) {
        const unsigned shift = bits * p / passes;
        return p < passes ? Digit{shift, (cl_uint{1} << (bits * (p + 1) / passes - shift)) - 1} : Digit{0, 0};
    };
    const uint64_t tiles = tiles_for(count);
    const bool few = !kernels_.serial() && tiles <= kFewTiles;
    for (unsigned p = 0; p < passes; ++p) {
        const cl::Buffer(&from)[2] = p % 2 == 0 ? theirs : ours;
        if (!few) {
            start(count_, from[0], count, digit(p), tiles);
            scan_.run(counts_, tiles * (digit(p).mask + 1));
        } else if (p == 0) {
            count_few_.setArg(5, cl_uint{passes});
            start(count_few_, from[0], count, digit(p), tiles);
        }
        move(from, p % 2 == 0 ? ours : theirs, count, digit(p), few, p, digit(p + 1));
    }
}

// Counts the digits of all tiles.
void DeviceSort::start(cl::Kernel& kernel, const cl::Buffer& keys, uint64_t count, Digit digit, uint64_t tiles) {
    kernel.setArg(0, keys);
    kernel.setArg(1, static_cast<cl_uint>(count));
    kernel.setArg(2, digit.shift);
    kernel.setArg(3, digit.mask);
    kernel.setArg(4, counts_);
    kernels_.launch(kernel, tiles);
}

void DeviceSort::move(const cl::Buffer (&from)[2], const cl::Buffer (&to)[2], uint64_t count, Digit digit, bool few,
                      unsigned pass, Digit next) {
    move_.setArg(0, from[0]);
    move_.setArg(1, from[1]);
    move_.setArg(2, static_cast<cl_uint>(count));
    move_.setArg(3, digit.shift);
    move_.setArg(4, digit.mask);
    move_.setArg(5, counts_);
    move_.setArg(6, to[0]);
    move_.setArg(7, to[1]);
    if (!kernels_.serial()) {
        move_.setArg(8, cl_uint{few});
        move_.setArg(9, cl_uint{pass});
        move_.setArg(10, next.shift);
        move_.setArg(11, next.mask);
    }
    kernels_.launch(move_, tiles_for(count));
}

}  // namespace clarity
