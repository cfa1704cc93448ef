#include "clarity_bvh/wide/grid.hpp"

#include <algorithm>
#include <cfloat>
#include <limits>

namespace clarity::bvh {
namespace {

// A cell may be this many bits below the highest bit of a coordinate: finer than the coordinate's own last bit.
constexpr int kFinestOfCoordinate = 24;

float at_most(double x) {
    const auto nearest = static_cast<float>(x);
    return nearest > x ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
}

}  // namespace

Grid Grid::around(const GridRule& rule, float lo, float hi) {
    const double extent = double{hi} - lo, farthest = std::max(std::fabs(double{lo}), std::fabs(double{hi}));
    int exponent = rule.least_exponent;
    if (extent > 0) exponent = std::max(exponent, std::ilogb(extent / kPlanes));
    if (farthest > 0) exponent = std::max(exponent, std::ilogb(farthest) - kFinestOfCoordinate);
    for (; exponent <= rule.most_exponent; ++exponent) {
        const double cell = std::ldexp(1.0, exponent), origin = lo - (double{rule.margin} + rule.bias) * cell;
        if (origin < -FLT_MAX) break;
        // The bytes of lower bounds are not below 0, because the origin is rounded down.
        const Grid grid(rule, at_most(origin), exponent);
        if (grid.upper(hi) <= kPlanes) return grid;
    }
    return {rule, std::numeric_limits<float>::quiet_NaN(), 0};
}

}  // namespace clarity::bvh
