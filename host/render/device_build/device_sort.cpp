#include "render/device_build/device_sort.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr unsigned kDigitBits = 8;  // of a pass, at most: RT_DIGITS of sort.cl

}  // namespace

DeviceSort::DeviceSort(const BuildKernels& kernels, uint64_t most, SortKeys keys)
    : kernels_(kernels),
      most_(most),
      key_bytes_(keys == SortKeys::bits32 ? 4 : 8),
      scan_(kernels, tiles_for(most) << kDigitBits) {
    const cl::Program program = kernels.compile_file("sort.cl", key_bytes_ == 4 ? "-DRT_KEY=uint" : "-DRT_KEY=ulong");
    count_ = cl::Kernel(program, "sort_count");
    move_ = cl::Kernel(program, "sort_move");
    const uint64_t counts = 4 * tiles_for(most) << kDigitBits;
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
    for (unsigned p = 0; p < passes; ++p) {
        const unsigned shift = bits * p / passes, end = bits * (p + 1) / passes;
        if (p % 2 == 0)
            pass(theirs, ours, count, shift, end - shift);
        else
            pass(ours, theirs, count, shift, end - shift);
    }
}

void DeviceSort::pass(const cl::Buffer (&from)[2], const cl::Buffer (&to)[2], uint64_t count, unsigned shift, unsigned bits) {
    const uint64_t tiles = tiles_for(count);
    const auto pairs = static_cast<cl_uint>(count);
    const cl_uint mask = (1u << bits) - 1;
    count_.setArg(0, from[0]);
    count_.setArg(1, pairs);
    count_.setArg(2, cl_uint{shift});
    count_.setArg(3, mask);
    count_.setArg(4, counts_);
    kernels_.launch(count_, tiles);
    scan_.run(counts_, tiles << bits);
    move_.setArg(0, from[0]);
    move_.setArg(1, from[1]);
    move_.setArg(2, pairs);
    move_.setArg(3, cl_uint{shift});
    move_.setArg(4, mask);
    move_.setArg(5, counts_);
    move_.setArg(6, to[0]);
    move_.setArg(7, to[1]);
    kernels_.launch(move_, tiles);
}

}  // namespace clarity
