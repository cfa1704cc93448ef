// binning.hpp -- the surface area heuristic over bins (Wald 2007, "On fast Construction of SAH-based Bounding Volume
// Hierarchies"): primitives are counted and bounded in equal slices of their centroids' extent, on all three axes at once, and
// only the planes between slices are candidates. One pass over the primitives per node, whatever their number.
#pragma once
#include <cmath>
#include <cstddef>

#include "vec4.hpp"

namespace bvh2 {

// A primitive while the tree is built: its box, and its ref in the bits of lo[3]. hi[3] is 0. 32 B.
struct alignas(16) Record {
    float lo[4], hi[4];
    uint32_t ref() const {
        uint32_t r;
        std::memcpy(&r, &lo[3], sizeof r);
        return r;
    }
    void set_ref(uint32_t r) { std::memcpy(&lo[3], &r, sizeof r); }
    Box box() const { return {xyz(load(lo)), load(hi)}; }
    // Twice the centroid: spares a multiplication, and nobody needs the half. Infinite for coordinates beyond FLT_MAX / 2.
    Vec4 centroid2() const { return xyz(load(lo)) + load(hi); }
};

constexpr uint32_t kMaxBins = 32;

// From a centroid to the number of its slice on each axis.
struct Slices {
    Vec4 base, scale, last;
    uint32_t count;

    Slices(const Box& centroids2, uint32_t slice_count) : base(centroids2.lo), count(slice_count) {
        // An axis without extent (or with a subnormal one) gets a huge but finite scale, and all of it lies in slice 0.
        scale = min(splat(static_cast<float>(slice_count)) / xyz(centroids2.hi - centroids2.lo), splat(FLT_MAX));
        last = splat(static_cast<float>(slice_count - 1));
    }
    // As floats, not yet truncated.
    Vec4 position(Vec4 centroid2) const { return min((centroid2 - base) * scale, last); }
};

struct Bins {
    Vec4 lo[kMaxBins][3], hi[kMaxBins][3];
    alignas(16) uint32_t count[kMaxBins][4];

    void clear(uint32_t bin_count) {
        const Vec4 far = splat(FLT_MAX), near = splat(-FLT_MAX);
        for (uint32_t b = 0; b < bin_count; ++b)
            for (int axis = 0; axis < 3; ++axis) {
                lo[b][axis] = far;
                hi[b][axis] = near;
            }
        std::memset(count, 0, bin_count * sizeof count[0]);
    }

    void add(const Record* first, const Record* end, const Slices& slices) {
        for (const Record* r = first; r != end; ++r) {
            const Vec4 r_lo = xyz(load(r->lo)), r_hi = load(r->hi);
            uint32_t b[3];
            to_index(slices.position(r_lo + r_hi), b);
            for (int axis = 0; axis < 3; ++axis) {
                lo[b[axis]][axis] = min(lo[b[axis]][axis], r_lo);
                hi[b[axis]][axis] = max(hi[b[axis]][axis], r_hi);
                ++count[b[axis]][axis];
            }
        }
    }

    void add(const Bins& other, uint32_t bin_count) {
        for (uint32_t b = 0; b < bin_count; ++b) {
            for (int axis = 0; axis < 3; ++axis) {
                lo[b][axis] = min(lo[b][axis], other.lo[b][axis]);
                hi[b][axis] = max(hi[b][axis], other.hi[b][axis]);
            }
            store_counts(count[b], load_counts(count[b]) + load_counts(other.count[b]));
        }
    }
};

// Areas are compared within one node only, so they are taken of boxes scaled to the node's longest side: neither huge nor tiny
// coordinates overflow or vanish. The little that is added to each side keeps lines and points from costing nothing.
struct AreaScale {
    Vec4 scale, pad = splat(1e-5f);
    explicit AreaScale(const Box& node) {
        alignas(16) float e[4];
        store(e, node.hi - node.lo);
        const float longest = e[0] > e[1] ? (e[0] > e[2] ? e[0] : e[2]) : (e[1] > e[2] ? e[1] : e[2]);
        scale = splat(longest > 1.0f / FLT_MAX ? 1.0f / longest : FLT_MAX);
    }
    // Half the area of three boxes at once, in lanes 0..2. NaN for an empty box.
    Vec4 half_areas(const Vec4 lo[3], const Vec4 hi[3]) const {
        Vec4 x, y, z;
        transpose3((hi[0] - lo[0]) * scale + pad, (hi[1] - lo[1]) * scale + pad, (hi[2] - lo[2]) * scale + pad, x, y, z);
        return x * y + z * (x + y);
    }
    float half_area(const Box& box) const {
        alignas(16) float e[4];
        store(e, (box.hi - box.lo) * scale + pad);
        return e[0] * e[1] + e[2] * (e[0] + e[1]);
    }
};

// Primitives of slices below `bin` go left.
struct Split {
    float cost = INFINITY;  // sum over both sides of half area (by AreaScale) times primitives; infinite: there is none
    int axis = 0;
    uint32_t bin = 0, left_count = 0;
    Box left, right;
};

inline Split find_split(const Bins& bins, uint32_t bin_count, const AreaScale& area, uint32_t primitive_count) {
    // Sweep from the right: areas of all that lies at or right of each plane.
    Vec4 right_area[kMaxBins];
    Vec4 lo[3] = {splat(FLT_MAX), splat(FLT_MAX), splat(FLT_MAX)}, hi[3] = {splat(-FLT_MAX), splat(-FLT_MAX), splat(-FLT_MAX)};
    for (uint32_t b = bin_count - 1; b > 0; --b) {
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = min(lo[axis], bins.lo[b][axis]);
            hi[axis] = max(hi[axis], bins.hi[b][axis]);
        }
        right_area[b] = area.half_areas(lo, hi);
    }
    // Sweep from the left, with the cost of each plane. A side without primitives has an area of NaN and so never wins.
    for (int axis = 0; axis < 3; ++axis) {
        lo[axis] = splat(FLT_MAX);
        hi[axis] = splat(-FLT_MAX);
    }
    alignas(16) const uint32_t none[4] = {0, 0, 0, 0};
    Count4 left = load_counts(none);
    const Vec4 all = splat(static_cast<float>(primitive_count));
    Vec4 best_cost = splat(INFINITY), best_bin = splat(0.0f);
    for (uint32_t b = 1; b < bin_count; ++b) {
        for (int axis = 0; axis < 3; ++axis) {
            lo[axis] = min(lo[axis], bins.lo[b - 1][axis]);
            hi[axis] = max(hi[axis], bins.hi[b - 1][axis]);
        }
        left = left + load_counts(bins.count[b - 1]);
        const Vec4 left_f = to_float(left);
        const Vec4 cost = area.half_areas(lo, hi) * left_f + right_area[b] * (all - left_f);
        const Vec4 better = less(cost, best_cost);
        best_cost = select(better, cost, best_cost);
        best_bin = select(better, splat(static_cast<float>(b)), best_bin);
    }
    alignas(16) float costs[4], planes[4];
    store(costs, best_cost);
    store(planes, best_bin);
    Split split;
    for (int axis = 0; axis < 3; ++axis)
        if (costs[axis] < split.cost) {
            split.cost = costs[axis];
            split.axis = axis;
            split.bin = static_cast<uint32_t>(planes[axis]);
        }
    for (uint32_t b = 0; b < bin_count && split.bin != 0; ++b) {
        Box& side = b < split.bin ? split.left : split.right;
        side.add(Box{bins.lo[b][split.axis], bins.hi[b][split.axis]});
        if (b < split.bin) split.left_count += bins.count[b][split.axis];
    }
    return split;
}

}  // namespace bvh2
