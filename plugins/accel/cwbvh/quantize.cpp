#include "quantize.hpp"

#include <algorithm>
#include <cmath>

#include "clarity_bvh/wide/grid.hpp"

namespace cwbvh {
namespace {

using clarity::bvh::Grid;
using clarity::bvh::kEmpty;

constexpr int kExponentBias = 127;  // as in a float
// The smallest cell for which the steps of a ray are normal numbers, and the largest for which CWBVH_BIAS cells stay below
// FLT_MAX.
constexpr clarity::bvh::GridRule kRule{CWBVH_BIAS, CWBVH_MARGIN, -100, 112};

}  // namespace

void quantize(const WideNode& from, cwbvh_node& to) {
    to.cells &= 0xFF000000u;
    for (int a = 0; a < 3; ++a) {
        float lo = 0, hi = 0;
        bool any = false;
        for (int slot = 0; slot < 8; ++slot) {
            if (from.child[slot] == kEmpty) continue;
            lo = any ? std::min(lo, from.plane[a][slot]) : from.plane[a][slot];
            hi = any ? std::max(hi, from.plane[3 + a][slot]) : from.plane[3 + a][slot];
            any = true;
        }
        const Grid grid = Grid::around(kRule, lo, hi);
        to.origin[a] = grid.origin();
        to.cells |= static_cast<rt_u32>(grid.exponent() + kExponentBias) << 8 * a;
        std::fill_n(to.planes[a], 4, 0u);
        for (uint32_t slot = 0; slot < 8; ++slot) {
            const bool empty = from.child[slot] == kEmpty || grid.unbounded();
            const int low = empty ? Grid::kPlanes : grid.lower(from.plane[a][slot]),
                      high = empty ? 0 : grid.upper(from.plane[3 + a][slot]);
            to.planes[a][slot / 4] |= static_cast<rt_u32>(low) << 8 * (slot % 4);
            to.planes[a][2 + slot / 4] |= static_cast<rt_u32>(high) << 8 * (slot % 4);
        }
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
