// rounding.hpp -- the floats next to numbers of double precision, for boxes that must not lose what they hold.
#pragma once
#include <cmath>
#include <cstdint>
#include <cstring>

namespace clarity::bvh {

// The greatest float that is not above x. By the sign of a difference: a comparison becomes a branch, which is predicted
// wrongly every other time, since half of all numbers are rounded up. In a refit of spheres that took half of the time.
inline float rounded_down(double x) {
    const auto nearest = static_cast<float>(x);
    if (nearest == 0 || std::isinf(nearest)) return nearest > x ? std::nextafter(nearest, -INFINITY) : nearest;
    const double above = x - nearest;
    uint64_t is_above;
    std::memcpy(&is_above, &above, sizeof is_above);
    int32_t bits;  // of the nearest float; the next one below has one less above 0, and one more below
    std::memcpy(&bits, &nearest, sizeof bits);
    bits += static_cast<int32_t>(is_above >> 63) * (1 | ~(bits >> 31));
    float below;
    std::memcpy(&below, &bits, sizeof below);
    return below;
}

// The least float that is not below x.
inline float rounded_up(double x) {
    return -rounded_down(-x);
}

}  // namespace clarity::bvh
