#include "clarity_bvh/wide/grid.hpp"

#include <algorithm>
#include <cfloat>
#include <limits>

namespace clarity::bvh {
namespace {

// A cell may be this many bits below the highest bit of a coordinate: finer than the coordinate's own last bit.
constexpr int kFinestOfCoordinate = 24;

constexpr float kLeastMargin = 1e-6f;  // above the rounding of a quotient

float at_most(double x) {
    const auto nearest = static_cast<float>(x);
    if (nearest == 0 || std::isinf(nearest))
        return nearest > x ? std::nextafter(nearest, -std::numeric_limits<float>::infinity()) : nearest;
    // The next float below, without a branch that is taken every other time.
    int32_t bits;
    std::memcpy(&bits, &nearest, sizeof bits);
    bits += static_cast<int32_t>(nearest > x) * (1 | ~(bits >> 31));
    float below;
    std::memcpy(&below, &bits, sizeof below);
    return below;
}

// std::ilogb() of a normal number above 0, in a fraction of its time. Differences of floats are never denormal as doubles.
int exponent_of(double x) {
    uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    return static_cast<int>(bits >> 52) - 1023;
}

}  // namespace

Grid Grid::around(const GridRule& rule, float lo, float hi) {
    const double extent = double{hi} - lo, farthest = std::max(std::fabs(double{lo}), std::fabs(double{hi}));
    int exponent = rule.least_exponent;
    // 255 cells of at most extent / 255 do not hold the margins, too.
    const int more = rule.margin > kLeastMargin ? 1 : 0;
    if (extent > 0) exponent = std::max(exponent, exponent_of(extent / kPlanes) + more);
    if (farthest > 0) exponent = std::max(exponent, exponent_of(farthest) - kFinestOfCoordinate);
    for (; exponent <= rule.most_exponent; ++exponent) {
        const double cell = power_of_two(exponent), origin = lo - (double{rule.margin} + rule.bias) * cell;
        if (origin < -FLT_MAX) break;
        // The bytes of lower bounds are not below 0, because the origin is rounded down.
        const Grid grid(rule, at_most(origin), exponent);
        if (grid.upper(hi) <= kPlanes) return grid;
    }
    return {rule, std::numeric_limits<float>::quiet_NaN(), 0};
}

}  // namespace clarity::bvh
