#include "quantize.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>

namespace cwbvh {
namespace {

constexpr int kPlanes = 255;          // the highest value of a byte
constexpr int kExponentBias = 127;    // as in a float
constexpr int kLeastExponent = -100;  // of the smallest cell for which the steps of a ray are normal numbers
constexpr int kMostExponent = 112;    // of the largest cell for which CWBVH_BIAS cells stay below FLT_MAX
// A cell may be this many bits below the highest bit of a coordinate: finer than the coordinate's own last bit.
constexpr int kFinestOfCoordinate = 24;

// The quantisation grid of one axis.
struct Grid {
    float origin;
    int exponent;
    double cell, per_cell, base;  // base: coordinate of byte 0

    Grid(float at, int e)
        : origin(at), exponent(e), cell(std::ldexp(1.0, e)), per_cell(std::ldexp(1.0, -e)), base(at + CWBVH_BIAS * cell) {}
    // Neither result is below 0, because the lowest plane of the node lies above `base`.
    int lower(float plane) const { return static_cast<int>((plane - base) * per_cell - double{CWBVH_MARGIN}); }
    int upper(float plane) const {
        const double at = (plane - base) * per_cell + double{CWBVH_MARGIN};
        return static_cast<int>(at) + (static_cast<int>(at) < at);
    }
};

float at_most(double x) {
    const auto nearest = static_cast<float>(x);
    return nearest > x ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
}

Grid grid_of(float lo, float hi) {
    const double extent = double{hi} - lo, farthest = std::max(std::fabs(double{lo}), std::fabs(double{hi}));
    int exponent = kLeastExponent;
    if (extent > 0) exponent = std::max(exponent, std::ilogb(extent / kPlanes));
    if (farthest > 0) exponent = std::max(exponent, std::ilogb(farthest) - kFinestOfCoordinate);
    for (; exponent <= kMostExponent; ++exponent) {
        const double cell = std::ldexp(1.0, exponent), origin = lo - (double{CWBVH_MARGIN} + CWBVH_BIAS) * cell;
        if (origin < -FLT_MAX) break;
        const Grid grid(at_most(origin), exponent);
        if (grid.upper(hi) <= kPlanes) return grid;
    }
    return {std::numeric_limits<float>::quiet_NaN(), 0};
}

}  // namespace

void quantize(const bvh8_node& from, cwbvh_node& to) {
    to.cells &= 0xFF000000u;
    for (int a = 0; a < 3; ++a) {
        float lo = 0, hi = 0;
        bool any = false;
        for (int slot = 0; slot < BVH8_WIDTH; ++slot) {
            if (from.child[slot] == BVH8_EMPTY) continue;
            lo = any ? std::min(lo, from.plane[a][slot]) : from.plane[a][slot];
            hi = any ? std::max(hi, from.plane[3 + a][slot]) : from.plane[3 + a][slot];
            any = true;
        }
        const Grid grid = grid_of(lo, hi);
        const bool unbounded = std::isnan(grid.origin);
        to.origin[a] = grid.origin;
        to.cells |= static_cast<rt_u32>(grid.exponent + kExponentBias) << 8 * a;
        std::fill_n(to.planes[a], 4, 0u);
        for (uint32_t slot = 0; slot < BVH8_WIDTH; ++slot) {
            const bool empty = from.child[slot] == BVH8_EMPTY || unbounded;
            const int low = empty ? kPlanes : grid.lower(from.plane[a][slot]),
                      high = empty ? 0 : grid.upper(from.plane[3 + a][slot]);
            to.planes[a][slot / 4] |= static_cast<rt_u32>(low) << 8 * (slot % 4);
            to.planes[a][2 + slot / 4] |= static_cast<rt_u32>(high) << 8 * (slot % 4);
        }
    }
}

void box_of(const cwbvh_node& node, uint32_t slot, double lo[3], double hi[3]) {
    for (int a = 0; a < 3; ++a) {
        if (std::isnan(node.origin[a])) {
            lo[a] = -HUGE_VAL;
            hi[a] = HUGE_VAL;
            continue;
        }
        const Grid grid(node.origin[a], static_cast<int>(node.cells >> 8 * a & 255u) - kExponentBias);
        const auto plane = [&](uint32_t word) {
            return grid.base + grid.cell * (node.planes[a][word] >> 8 * (slot % 4) & 255u);
        };
        lo[a] = plane(slot / 4);
        hi[a] = plane(2 + slot / 4);
    }
}

}  // namespace cwbvh
