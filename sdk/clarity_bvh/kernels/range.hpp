// range.hpp -- the data that the builders work on: records of primitives, ranges of records, bins and splits.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "clarity_bvh/base/bounds.hpp"
#include "clarity_bvh/rules.hpp"

namespace clarity::bvh {

// A primitive during the build: its box, and its ref in the bits of lo[3]. neg_hi[3] is 0. 32 bytes.
struct alignas(32) Record {
    float lo[4], neg_hi[4];
    uint32_t ref() const {
        uint32_t r;
        std::memcpy(&r, &lo[3], sizeof r);
        return r;
    }
    void set_ref(uint32_t r) { std::memcpy(&lo[3], &r, sizeof r); }
    // Twice the centroid, because no comparison needs the exact half and this saves a multiplication. Infinite for coordinates
    // beyond FLT_MAX / 2.
    float centroid2(int axis) const { return lo[axis] - neg_hi[axis]; }
};

// A part of the primitives that becomes one subtree. A split moves a range from one of two buffers to the other; that needs
// neither swaps nor unpredictable branches.
struct Range {
    uint32_t begin = 0, end = 0;
    uint32_t buffer = 0;  // which of the two buffers holds it, 0 or 1
    uint32_t depth = 0;   // number of nodes above it
    Bounds box, centroids2;
    uint32_t count() const { return end - begin; }
};

// True if the range is not so deep that it must be halved.
inline bool depth_to_spare(const Rules& rules, const Range& range) {
    return !rules.halves && range.depth + log2_ceil(range.count()) < kMaxDepth;
}

// True if the range may be binned. Slices need a finite extent of the centroids.
inline bool may_bin(const Rules& rules, const Range& range) {
    bool finite = true;
    for (int a = 0; a < 3; ++a) finite = finite && range.centroids2.hi(a) - range.centroids2.lo[a] < FLT_MAX;
    return finite && depth_to_spare(rules, range);
}

// Few primitives get few bins: sweeping empty bins would cost more than it finds.
inline uint32_t bins_for(const Rules& rules, uint32_t primitive_count) {
    return std::min(rules.bins, 4 + primitive_count / 4);
}

// Maps a centroid to its slice number on each axis.
struct Slices {
    Vec4 base, scale, last;
    uint32_t count;

    Slices(const Bounds& centroids2, uint32_t slice_count) : base(xyz(load(centroids2.lo))), count(slice_count) {
        // An axis without extent (or with a subnormal one) gets a huge finite scale, so that everything on it lies in slice 0.
        const Vec4 extent = splat(0.0f) - xyz(load(centroids2.lo) + load(centroids2.neg_hi));
        scale = min(splat(static_cast<float>(slice_count)) / extent, splat(FLT_MAX));
        last = splat(static_cast<float>(slice_count - 1));
    }
    // The slice numbers as floats, not yet truncated.
    Vec4 position(Vec4 centroid2) const { return min((centroid2 - base) * scale, last); }
};

// Counts and bounds of the primitives in each slice, for all three axes.
struct Bins {
    Bounds box[kMaxBins][3];
    alignas(16) uint32_t count[kMaxBins][4];
};

// A split of a range: primitives in slices below `bin` go left.
struct Split {
    float cost = INFINITY;  // sum over both sides of half area (by AreaScale) times primitives; infinite: no split found
    int axis = 0;
    uint32_t bin = 0, left_count = 0;
    Bounds left, right;
};

// Sets the two ranges of a split, except the bounds of their centroids (left empty).
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

// Computes areas relative to the longest side of one node's box. Areas are compared within one node only, and with this scale
// huge coordinates do not overflow and tiny ones do not vanish. A small padding of each side gives lines and points a cost
// above zero.
struct AreaScale {
    Vec4 scale, pad = splat(1e-5f);
    explicit AreaScale(const Bounds& node) {
        float longest = 0;
        for (int a = 0; a < 3; ++a) longest = std::max(longest, node.hi(a) - node.lo[a]);
        scale = splat(longest > 1.0f / FLT_MAX ? 1.0f / longest : FLT_MAX);
    }
    // The negated side lengths; products of two are the same as without the sign.
    Vec4 sides(Vec4 lo, Vec4 neg_hi) const { return (lo + neg_hi) * scale - pad; }
    float half_area(const Bounds& box) const {
        alignas(16) float e[4];
        store(e, sides(xyz(load(box.lo)), xyz(load(box.neg_hi))));
        return e[0] * e[1] + e[2] * (e[0] + e[1]);
    }
};

// The child with the larger surface comes first: rays visit it more often, and the first child lies next to its parent in
// memory.
inline bool right_is_larger(const AreaScale& area, const Range& left, const Range& right) {
    return area.half_area(left.box) < area.half_area(right.box);
}

}  // namespace clarity::bvh
