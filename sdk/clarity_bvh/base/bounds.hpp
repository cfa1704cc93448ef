// bounds.hpp -- an axis-aligned box in the form that builders grow it in.
#pragma once
#include "clarity_bvh/base/vec4.hpp"

namespace clarity::bvh {

// A box with negated upper bounds: to grow it is one minimum over eight floats. The fourth lanes are unused. A new box is
// empty: it contains nothing, and add() then gives the other box. 32 bytes.
struct alignas(32) Bounds {
    float lo[4] = {FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX}, neg_hi[4] = {FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX};

    void add(const Bounds& b) {
        store(lo, min(load(lo), load(b.lo)));
        store(neg_hi, min(load(neg_hi), load(b.neg_hi)));
    }
    // Grows the box by one with the given corners, three numbers each.
    void add(const float low[3], const float high[3]) {
        for (int a = 0; a < 3; ++a) {
            lo[a] = low[a] < lo[a] ? low[a] : lo[a];
            neg_hi[a] = -high[a] < neg_hi[a] ? -high[a] : neg_hi[a];
        }
    }
    float hi(int axis) const { return -neg_hi[axis]; }
};

// Returns the factor from half a length to that length in units of the box's longest side. Returns FLT_MAX for a box without
// extent. Areas by this scale neither overflow for huge coordinates nor vanish for tiny ones.
inline float unit_scale(const Bounds& box) {
    double longest = 0;
    for (int a = 0; a < 3; ++a) {
        const double side = double{box.hi(a)} - box.lo[a];
        longest = longest < side ? side : longest;
    }
    return longest > 2.0 / FLT_MAX ? static_cast<float>(2 / longest) : FLT_MAX;
}

// Added to each side length, so that lines and points cost more than nothing. Too small to matter for anything that has an
// area.
constexpr float kLeastSide = 1e-12f;

// Half the surface of a box, by unit_scale(). Halves the coordinates before it subtracts them, so that no length overflows.
inline float half_area(Vec4 lo, Vec4 hi, float scale) {
    const Vec4 half = splat(0.5f);
    alignas(16) float e[4];
    store(e, splat(kLeastSide) + splat(scale) * (half * xyz(hi) - half * xyz(lo)));
    return e[0] * e[1] + e[2] * (e[0] + e[1]);
}
// Reads seven numbers.
inline float half_area(const float box[6], float scale) {
    return half_area(load_any(box), load_any(box + 3), scale);
}

}  // namespace clarity::bvh
