// refit_box.hpp -- what a refit knows of a subtree: its box, and the sums of areas that its cost is made of.
#pragma once
#include "clarity_bvh/base/vec4.hpp"
#include "rt_plugin.hpp"

namespace clarity::bvh {

// An axis-aligned box. The fourth lanes hold anything. A new one is empty.
struct RefitBox {
    Vec4 lo = splat(FLT_MAX), hi = splat(-FLT_MAX);
    void add(const RefitBox& other) {
        lo = min(lo, other.lo);
        hi = max(hi, other.hi);
    }
    void add(const rt_prim& prim) {
        lo = min(lo, load_any(prim.lo));
        hi = max(hi, load_any(prim.hi));
    }
    bool empty() const {
        alignas(16) float low[4], high[4];
        store(low, lo);
        store(high, hi);
        return low[0] > high[0];
    }
    // Writes lo.xyz, hi.xyz and leaves the number behind them as it is.
    void write(float box[7]) const {
        const float behind = box[6];
        store_any(box, lo);
        store_any(box + 3, hi);
        box[6] = behind;
    }
};

// Areas of nodes and of primitives (leaf boxes times their numbers of primitives) in some unit. Lane by lane: x y, y z and z x.
struct RefitAreas {
    Vec4 nodes = splat(0.0f), primitives = splat(0.0f);
};

// The unit of areas in a group: the square of a length, so that they neither overflow for huge coordinates nor vanish for tiny
// ones. per_length: 1 by that length, as unit_scale() gives it; of a box without extent 1 is taken.
struct RefitUnit {
    explicit RefitUnit(float per_length = 1) : per_side(splat(per_length < FLT_MAX ? per_length : 1)) {}
    Vec4 per_side;
    Vec4 area(const RefitBox& box) const {
        const Vec4 side = xyz(box.hi - box.lo) * per_side;  // the fourth lanes may be denormals, which are slow to multiply
        return side * turned(side);
    }

 private:
    // (y, z, x, 0)
    static Vec4 turned(Vec4 a) {
#ifdef CLARITY_BVH_SSE2
        return {_mm_shuffle_ps(a.m, a.m, _MM_SHUFFLE(3, 0, 2, 1))};
#else
        return {{a.v[1], a.v[2], a.v[0], a.v[3]}};
#endif
    }
};

// Half the area whose products of sides are these lanes.
inline double sum_of(Vec4 products) {
    alignas(16) float lanes[4];
    store(lanes, products);
    return double{lanes[0]} + lanes[1] + lanes[2];
}

}  // namespace clarity::bvh
