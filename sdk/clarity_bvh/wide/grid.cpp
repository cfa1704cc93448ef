#include "clarity_bvh/wide/grid.hpp"

#include <algorithm>
#include <cfloat>
#include <limits>

#include "clarity_bvh/base/rounding.hpp"

namespace clarity::bvh {
namespace {

// A cell may be this many bits below the highest bit of a coordinate: finer than the coordinate's own last bit.
constexpr int kFinestOfCoordinate = 24;

constexpr float kLeastMargin = 1e-6f;  // above the rounding of a quotient

// std::ilogb() of a normal number above 0, in a fraction of its time; of 0 it is less than of any. Floats and their differences
// are never denormal as doubles.
int exponent_of(double x) {
    uint64_t bits;
    std::memcpy(&bits, &x, sizeof bits);
    return static_cast<int>(bits >> 52) - 1023;
}

}  // namespace

Grid Grid::around(const GridRule& rule, float lo, float hi) {
    const double extent = double{hi} - lo;
    int exponent = rule.least_exponent;
    // 255 cells of at most extent / 255 do not hold the margins, too.
    const int more = rule.margin > kLeastMargin ? 1 : 0;
    if (extent > 0) exponent = std::max(exponent, exponent_of(extent / kPlanes) + more);
    const int farthest = std::max(exponent_of(std::fabs(double{lo})), exponent_of(std::fabs(double{hi})));
    exponent = std::max(exponent, farthest - kFinestOfCoordinate);
    for (; exponent <= rule.most_exponent; ++exponent) {
        const double cell = power_of_two(exponent), origin = lo - (double{rule.margin} + rule.bias) * cell;
        if (origin < -FLT_MAX) break;
        // The bytes of lower bounds are not below 0, because the origin is rounded down.
        const Grid grid(rule, rounded_down(origin), exponent);
        if (grid.upper(hi) <= kPlanes) return grid;
    }
    return {rule, std::numeric_limits<float>::quiet_NaN(), 0};
}

}  // namespace clarity::bvh
