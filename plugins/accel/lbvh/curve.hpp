// curve.hpp -- the numbers that the build on the host and the plan for the device share.
#pragma once
#include <cstdint>

#include "rt_plugin.h"

namespace lbvh {

// Bits of a Morton code for each axis. The sort takes an even number of passes of 8 bits: 30 bits need four, 48 bits six.
constexpr uint64_t kMostWithShortCodes = uint64_t{1} << 18;
constexpr uint32_t axis_bits(uint64_t count) {
    return count <= kMostWithShortCodes ? 10 : 16;
}
constexpr uint32_t code_bits(uint64_t count) {
    return 3 * axis_bits(count);
}

// The bits of n: floor(log2(n)) + 1.
constexpr uint32_t bit_count(uint64_t n) {
    uint32_t bits = 0;
    for (; n > 0; n /= 2) ++bits;
    return bits;
}
// Inner nodes on the way from a root to a leaf, at most: each splits by a bit of its own, of the code or of the place.
constexpr uint32_t depth_bound(uint64_t count) {
    return code_bits(count) + bit_count(count);
}

}  // namespace lbvh
