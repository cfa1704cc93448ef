#include "quantize.hpp"

#include <cfloat>
#include <cmath>

#include "clarity_bvh/wide/grid.hpp"

namespace cwbvh {
namespace {

using namespace clarity::bvh;

constexpr int kExponentBias = CWBVH_EXPONENT_BIAS;  // as in a float
constexpr GridRule kRule{CWBVH_BIAS, CWBVH_MARGIN, CWBVH_LEAST_EXPONENT, CWBVH_MOST_EXPONENT};

// Eight numbers of 0..255 as bytes, the first one lowest.
uint64_t bytes_of(const int numbers[8]) {
    static_assert(Grid::kPlanes == 255, "an empty slot's lower plane has all bits");
#ifdef CLARITY_BVH_SSE2
    const __m128i a = _mm_loadu_si128(reinterpret_cast<const __m128i*>(numbers)),
                  b = _mm_loadu_si128(reinterpret_cast<const __m128i*>(numbers + 4)), words = _mm_packs_epi32(a, b);
    return static_cast<uint64_t>(_mm_cvtsi128_si64(_mm_packus_epi16(words, words)));
#else
    uint64_t bytes = 0;
    for (int i = 0; i < 8; ++i) bytes |= static_cast<uint64_t>(numbers[i]) << 8 * i;
    return bytes;
#endif
}

// Bit i of eight becomes the bits of byte i.
uint64_t spread(uint32_t bits) {
    const uint64_t far = (bits | uint64_t{bits} << 28) & 0x0000000F0000000Fu, two = (far | far << 14) & 0x0003000300030003u;
    return ((two | two << 7) & 0x0101010101010101u) * 255u;
}

}  // namespace

void quantize(const Bounds8& from, uint32_t used, cwbvh_node& to) {
    const Vec4 used_lanes[2] = {mask_of(used), mask_of(used >> 4)};
    const uint64_t empty_bytes = ~spread(used);
    to.cells &= 0xFF000000u;
    for (int a = 0; a < 3; ++a) {
        const auto chosen = [&](const Vec4 rows[2], int half, float otherwise) {
            return select(used_lanes[half], rows[half], splat(otherwise));
        };
        float lo = least(min(chosen(from.lo[a], 0, FLT_MAX), chosen(from.lo[a], 1, FLT_MAX)));
        float hi = greatest(max(chosen(from.hi[a], 0, -FLT_MAX), chosen(from.hi[a], 1, -FLT_MAX)));
        if (used == 0) lo = hi = 0;
        const Grid grid = Grid::around(kRule, lo, hi);
        to.origin[a] = grid.origin();
        to.cells |= static_cast<rt_u32>(grid.exponent() + kExponentBias) << 8 * a;
        int lower[8] = {}, upper[8] = {};
        if (!grid.unbounded()) {
            // Empty slots take a bound of the node meanwhile, because every coordinate must be within the grid.
            for (int half = 0; half < 2; ++half) {
                grid.lower_four(chosen(from.lo[a], half, lo), lower + 4 * half);
                grid.upper_four(chosen(from.hi[a], half, hi), upper + 4 * half);
            }
        }
        const uint64_t none = empty_bytes | (grid.unbounded() ? ~uint64_t{0} : 0);
        const uint64_t lows = bytes_of(lower) | none, highs = bytes_of(upper) & ~none;
        to.planes[a][0] = static_cast<rt_u32>(lows);
        to.planes[a][1] = static_cast<rt_u32>(lows >> 32);
        to.planes[a][2] = static_cast<rt_u32>(highs);
        to.planes[a][3] = static_cast<rt_u32>(highs >> 32);
    }
}

void quantize(const WideNode& from, cwbvh_node& to) {
    Bounds8 bounds;
    uint32_t used = 0;
    for (int a = 0; a < 3; ++a) {
        for (int half = 0; half < 2; ++half) {
            bounds.lo[a][half] = load_any(from.plane[a] + 4 * half);
            bounds.hi[a][half] = load_any(from.plane[3 + a] + 4 * half);
        }
    }
    for (uint32_t slot = 0; slot < 8; ++slot) used |= uint32_t{from.child[slot] != kEmpty} << slot;
    quantize(bounds, used, to);
}

void box_of(const cwbvh_node& node, uint32_t slot, double lo[3], double hi[3]) {
    for (int a = 0; a < 3; ++a) {
        const Grid grid(kRule, node.origin[a], static_cast<int>(node.cells >> 8 * a & 255u) - kExponentBias);
        const auto byte = [&](uint32_t word) { return node.planes[a][word] >> 8 * (slot % 4) & 255u; };
        lo[a] = grid.unbounded() ? -HUGE_VAL : grid.plane(byte(slot / 4));
        hi[a] = grid.unbounded() ? HUGE_VAL : grid.plane(byte(2 + slot / 4));
    }
}

}  // namespace cwbvh
