#include "render/device_build/device_sort.hpp"

#include <algorithm>

#include "base/error.hpp"

namespace clarity {
namespace {

constexpr unsigned kDigitBits = 8;  // of a pass, at most: RT_DIGITS of sort.cl
constexpr unsigned kPasses = 64 / kDigitBits;
// Sorts of no more pairs are one launch a pass. Their tiles are smaller, so that more work-groups share the work.
constexpr uint64_t kFewPairs = uint64_t{1} << 17;

unsigned passes_for(unsigned bits) {
    return (bits + kDigitBits - 1) / kDigitBits;
}

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

}  // namespace clarity
