#include "quantize.hpp"

#include <cfloat>
#include <cmath>

#include "clarity_bvh/wide/grid.hpp"

namespace cwbvh {
namespace {

using clarity::bvh::Grid;
using clarity::bvh::kEmpty;

constexpr int kExponentBias = CWBVH_EXPONENT_BIAS;  // as in a float
constexpr clarity::bvh::GridRule kRule{CWBVH_BIAS, CWBVH_MARGIN, CWBVH_LEAST_EXPONENT, CWBVH_MOST_EXPONENT};

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

}  // namespace

void quantize(const WideNode& from, cwbvh_node& to) {
    rt_u32 is_empty[8];
    uint64_t empty_bytes = 0;  // of a slot: 255, or 0
    for (int slot = 0; slot < 8; ++slot) {
        is_empty[slot] = from.child[slot] == kEmpty;
        empty_bytes |= uint64_t{is_empty[slot] ? 255u : 0u} << 8 * slot;
    }
    to.cells &= 0xFF000000u;
    for (int a = 0; a < 3; ++a) {
        float low[8], high[8], lo = FLT_MAX, hi = -FLT_MAX;
        for (int slot = 0; slot < 8; ++slot) {
            low[slot] = is_empty[slot] ? FLT_MAX : from.plane[a][slot];
            high[slot] = is_empty[slot] ? -FLT_MAX : from.plane[3 + a][slot];
            lo = low[slot] < lo ? low[slot] : lo;
            hi = hi < high[slot] ? high[slot] : hi;
        }
        if (empty_bytes == ~uint64_t{0}) lo = hi = 0;
        const Grid grid = Grid::around(kRule, lo, hi);
        to.origin[a] = grid.origin();
        to.cells |= static_cast<rt_u32>(grid.exponent() + kExponentBias) << 8 * a;
        // Empty slots take a bound of the node meanwhile, because every coordinate must be within the grid.
        int lower[8] = {}, upper[8] = {};
        for (int slot = 0; slot < 8; ++slot) {
            low[slot] = is_empty[slot] ? lo : low[slot];
            high[slot] = is_empty[slot] ? hi : high[slot];
        }
        if (!grid.unbounded()) {
            for (int slot = 0; slot < 8; slot += 4) {
                grid.lower_four(low + slot, lower + slot);
                grid.upper_four(high + slot, upper + slot);
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

void box_of(const cwbvh_node& node, uint32_t slot, double lo[3], double hi[3]) {
    for (int a = 0; a < 3; ++a) {
        const Grid grid(kRule, node.origin[a], static_cast<int>(node.cells >> 8 * a & 255u) - kExponentBias);
        const auto byte = [&](uint32_t word) { return node.planes[a][word] >> 8 * (slot % 4) & 255u; };
        lo[a] = grid.unbounded() ? -HUGE_VAL : grid.plane(byte(slot / 4));
        hi[a] = grid.unbounded() ? HUGE_VAL : grid.plane(byte(2 + slot / 4));
    }
}

}  // namespace cwbvh
