// partition.hpp -- ranges of primitives, and how one becomes two.
#pragma once
#include <algorithm>

#include "binning.hpp"

namespace bvh2 {

// Part of the primitives that will be one subtree. There are two buffers: a split moves a range from one to the other, which
// needs neither swaps nor unpredictable branches.
struct Range {
    uint32_t begin = 0, end = 0;
    uint32_t buffer = 0;  // 0 or 1: which one holds it
    uint32_t depth = 0;   // nodes above it
    Box box, centroids2;
    uint32_t count() const { return end - begin; }
};

// What a tree costs and where it stops.
struct Rules {
    uint32_t max_leaf, bins;
    float traversal_cost, intersection_cost;
    bool halves = false;  // by count, without the heuristic: what it gains is measured against this
};

// No leaf is deeper: from where the rest, halved by count, would just fit, ranges are halved. Scenes that pile primitives into
// each other by the thousand or shrink geometrically would otherwise grow chains.
constexpr uint32_t kMaxDepth = 64;

inline uint32_t log2_ceil(uint32_t n) {
    uint32_t bits = 0;
    while ((uint64_t{1} << bits) < n) ++bits;
    return bits;
}

// Whether the heuristic may choose: if it is asked for, with depth to spare, and centroids whose extent is a number.
inline bool may_use_heuristic(const Rules& rules, const Range& range) {
    if (rules.halves) return false;
    alignas(16) float extent[4];
    store(extent, range.centroids2.hi - range.centroids2.lo);
    const bool finite = extent[0] < FLT_MAX && extent[1] < FLT_MAX && extent[2] < FLT_MAX;
    return finite && range.depth + log2_ceil(range.count()) < kMaxDepth;
}

// Few primitives need few bins: the sweeps over empty ones would cost more than they find.
inline uint32_t bins_for(const Rules& rules, uint32_t primitive_count) {
    return std::min(rules.bins, 4 + primitive_count / 4);
}

// The two ranges of a split, but for the bounds of their centroids.
inline void begin_split(const Range& range, const Split& split, Range& left, Range& right) {
    left.begin = range.begin;
    left.end = right.begin = range.begin + split.left_count;
    right.end = range.end;
    left.buffer = right.buffer = range.buffer ^ 1;
    left.depth = right.depth = range.depth + 1;
    left.box = split.left;
    right.box = split.right;
    left.centroids2 = right.centroids2 = Box{};
}

// Copies [first, end) to where left and right point, keeping the order, and bounds the centroids of both sides.
inline void scatter(const Record* first, const Record* end, const Slices& slices, const Split& split, Record* left,
                    Record* right, Box& left_centroids2, Box& right_centroids2) {
    alignas(16) float bound[4] = {-1.0f, -1.0f, -1.0f, -1.0f};  // of the other axes: never reached
    bound[split.axis] = static_cast<float>(split.bin);
    const Vec4 plane = load(bound);
    const Vec4 far = splat(FLT_MAX), near = splat(-FLT_MAX);
    Box l = left_centroids2, r = right_centroids2;
    for (const Record* at = first; at != end; ++at) {
        const Vec4 lo = load(at->lo), hi = load(at->hi), centroid2 = xyz(lo) + hi;
        // position < bin is trunc(position) < bin, since bin is a whole number: the same side as the bins said.
        const uint32_t goes_left = any(less(slices.position(centroid2), plane));
        const Vec4 mask = all_lanes(goes_left);
        l.lo = min(l.lo, select(mask, centroid2, far));
        l.hi = max(l.hi, select(mask, centroid2, near));
        r.lo = min(r.lo, select(mask, far, centroid2));
        r.hi = max(r.hi, select(mask, near, centroid2));
        Record* to = goes_left ? left : right;
        store(to->lo, lo);
        store(to->hi, hi);
        left += goes_left;
        right += goes_left ^ 1u;
    }
    left_centroids2 = l;
    right_centroids2 = r;
}

inline void bound(const Record* first, const Record* end, Box& box, Box& centroids2) {
    for (const Record* r = first; r != end; ++r) {
        box.add(r->box());
        centroids2.add(r->centroid2());
    }
}

// Halves by count along the longest axis of the centroids, in place. For what the heuristic cannot split.
inline void halve(Record* records, const Range& range, Range& left, Range& right) {
    alignas(16) float lo[4], hi[4];
    store(lo, range.centroids2.lo);
    store(hi, range.centroids2.hi);
    int axis = 0;
    float longest = 0.0f;
    for (int a = 0; a < 3; ++a) {
        const float extent = 0.5f * hi[a] - 0.5f * lo[a];
        if (extent > longest) {
            longest = extent;
            axis = a;
        }
    }
    const uint32_t middle = range.begin + range.count() / 2;
    if (longest > 0.0f)  // else all are alike, and any half will do
        std::nth_element(records + range.begin, records + middle, records + range.end,
                         [axis](const Record& a, const Record& b) {
                             return 0.5f * a.lo[axis] + 0.5f * a.hi[axis] < 0.5f * b.lo[axis] + 0.5f * b.hi[axis];
                         });
    left.begin = range.begin;
    left.end = right.begin = middle;
    right.end = range.end;
    left.buffer = right.buffer = range.buffer;
    left.depth = right.depth = range.depth + 1;
    left.box = right.box = left.centroids2 = right.centroids2 = Box{};
    bound(records + left.begin, records + left.end, left.box, left.centroids2);
    bound(records + right.begin, records + right.end, right.box, right.centroids2);
}

}  // namespace bvh2
