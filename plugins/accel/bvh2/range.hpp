// range.hpp -- what a builder works on: boxes of primitives, ranges of them, and the rules by which ranges are split.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "vec4.hpp"

namespace bvh2 {

// A box with its upper bounds negated, so that growing it is one minimum over eight floats. The fourth lanes hold nothing. 32
// B.
struct alignas(32) Bounds {
    float lo[4] = {FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX}, neg_hi[4] = {FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX};
    void add(const Bounds& b) {
        store(lo, min(load(lo), load(b.lo)));
        store(neg_hi, min(load(neg_hi), load(b.neg_hi)));
    }
    float hi(int axis) const { return -neg_hi[axis]; }
};

// A primitive while the tree is built: its box, and its ref in the bits of lo[3]. neg_hi[3] is 0. 32 B.
struct alignas(32) Record {
    float lo[4], neg_hi[4];
    uint32_t ref() const {
        uint32_t r;
        std::memcpy(&r, &lo[3], sizeof r);
        return r;
    }
    void set_ref(uint32_t r) { std::memcpy(&lo[3], &r, sizeof r); }
    // Twice the centroid: spares a multiplication, and nobody needs the half. Infinite for coordinates beyond FLT_MAX / 2.
    float centroid2(int axis) const { return lo[axis] - neg_hi[axis]; }
};

// Where many are read one after the other, fetched so many before their turn: by itself a processor looks less far ahead.
constexpr uint32_t kStreamAhead = 64;

// Part of the primitives that will be one subtree. There are two buffers: a split moves a range from one to the other, which
// needs neither swaps nor unpredictable branches.
struct Range {
    uint32_t begin = 0, end = 0;
    uint32_t buffer = 0;  // 0 or 1: which one holds it
    uint32_t depth = 0;   // nodes above it
    Bounds box, centroids2;
    uint32_t count() const { return end - begin; }
};

// How ranges are split: by the surface area heuristic; along a space-filling curve, which is fast; or by the heuristic with
// primitives split as well where that pays, which is slow and good.
enum class Method { sah, morton, spatial };

// What a tree costs and where it stops.
struct Rules {
    uint32_t max_leaf, bins;
    float traversal_cost, intersection_cost;
    Method method = Method::sah;
    float duplicates = 0;  // references that spatial splits may add, as a share of the primitives
    bool halves = false;   // by count, without the heuristic: what it gains is measured against this
};

// No leaf is deeper: from where the rest, halved by count, would just fit, ranges are halved. Scenes that pile primitives into
// each other by the thousand or shrink geometrically would otherwise grow chains.
constexpr uint32_t kMaxDepth = 64;

inline uint32_t log2_ceil(uint32_t n) {
    uint32_t bits = 0;
    while ((uint64_t{1} << bits) < n) ++bits;
    return bits;
}

// Whether there is depth to spare for more than halves.
inline bool depth_to_spare(const Rules& rules, const Range& range) {
    return !rules.halves && range.depth + log2_ceil(range.count()) < kMaxDepth;
}

// Whether bins may choose: their slices need centroids whose extent is a number.
inline bool may_bin(const Rules& rules, const Range& range) {
    bool finite = true;
    for (int a = 0; a < 3; ++a) finite = finite && range.centroids2.hi(a) - range.centroids2.lo[a] < FLT_MAX;
    return finite && depth_to_spare(rules, range);
}

constexpr uint32_t kMaxBins = 32;

// Few primitives need few bins: the sweeps over empty ones would cost more than they find.
inline uint32_t bins_for(const Rules& rules, uint32_t primitive_count) {
    return std::min(rules.bins, 4 + primitive_count / 4);
}

// From a centroid to the number of its slice on each axis.
struct Slices {
    Vec4 base, scale, last;
    uint32_t count;

    Slices(const Bounds& centroids2, uint32_t slice_count) : base(xyz(load(centroids2.lo))), count(slice_count) {
        // An axis without extent (or with a subnormal one) gets a huge but finite scale, and all of it lies in slice 0.
        const Vec4 extent = splat(0.0f) - xyz(load(centroids2.lo) + load(centroids2.neg_hi));
        scale = min(splat(static_cast<float>(slice_count)) / extent, splat(FLT_MAX));
        last = splat(static_cast<float>(slice_count - 1));
    }
    // As floats, not yet truncated.
    Vec4 position(Vec4 centroid2) const { return min((centroid2 - base) * scale, last); }
};

// Counts and bounds of the primitives of each slice, on three axes at once.
struct Bins {
    Bounds box[kMaxBins][3];
    alignas(16) uint32_t count[kMaxBins][4];
};

// Where a range is parted: primitives of slices below `bin` go left.
struct Split {
    float cost = INFINITY;  // sum over both sides of half area (by AreaScale) times primitives; infinite: there is none
    int axis = 0;
    uint32_t bin = 0, left_count = 0;
    Bounds left, right;
};

// The two ranges of a split, but for the bounds of their centroids.
inline void begin_split(const Range& range, const Split& split, Range& left, Range& right) {
    left.begin = range.begin;
    left.end = right.begin = range.begin + split.left_count;
    right.end = range.end;
    left.buffer = right.buffer = range.buffer ^ 1;
    left.depth = right.depth = range.depth + 1;
    left.box = split.left;
    right.box = split.right;
    left.centroids2 = right.centroids2 = Bounds{};
}

// Areas are compared within one node only, so they are taken of boxes scaled to the node's longest side: neither huge nor tiny
// coordinates overflow or vanish. The little that is added to each side keeps lines and points from costing nothing.
struct AreaScale {
    Vec4 scale, pad = splat(1e-5f);
    explicit AreaScale(const Bounds& node) {
        float longest = 0;
        for (int a = 0; a < 3; ++a) longest = std::max(longest, node.hi(a) - node.lo[a]);
        scale = splat(longest > 1.0f / FLT_MAX ? 1.0f / longest : FLT_MAX);
    }
    // Negated, which areas do not mind.
    Vec4 sides(Vec4 lo, Vec4 neg_hi) const { return (lo + neg_hi) * scale - pad; }
    float half_area(const Bounds& box) const {
        alignas(16) float e[4];
        store(e, sides(xyz(load(box.lo)), xyz(load(box.neg_hi))));
        return e[0] * e[1] + e[2] * (e[0] + e[1]);
    }
};

// The child of larger surface comes first: it is the one visited more often, and so the one to lie beside its parent.
inline bool right_is_larger(const AreaScale& area, const Range& left, const Range& right) {
    return area.half_area(left.box) < area.half_area(right.box);
}

}  // namespace bvh2
