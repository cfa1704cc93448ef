// small_range.inl -- the surface area heuristic over every plane between two primitives, for ranges of at most kSmall
// primitives. For so few, sorting in registers costs less than binning, and it finds the best plane.
// Each kernels*.cpp includes this file once, for its instruction set.

namespace clarity::bvh {
namespace CLARITY_BVH_ISA {

constexpr uint32_t kSmall = 8;  // inputs of the sorting network; an index fits into the tag of a key

struct SmallSplit {
    float cost = INFINITY;  // as in Split
    uint32_t axis = 0, left_count = 0;
    alignas(16) uint32_t order[kSmall][4];  // order[k][axis]: index of the k-th primitive by centroid on that axis
};

// In each lane, moves the smaller value to a and the larger value to b.
inline void put_in_order(Vec4& a, Vec4& b) {
    const Vec4 smaller = min(a, b);
    b = max(a, b);
    a = smaller;
}

// Sorts by the centroids on all three axes at once, one axis a lane. It is a sorting network (Batcher 1968, odd-even merge), so
// no branch depends on a key. The index of a primitive replaces the lowest bits of its keys. Keys that differ only in these
// bits lose their true order.
inline void sort_small(const Record* records, uint32_t count, uint32_t order[kSmall][4]) {
    const Vec4 least = splat(-FLT_MAX), most = splat(FLT_MAX);
    Vec4 key[kSmall];
    for (uint32_t i = 0; i < count; ++i)
        key[i] = tag_all(min(max(centroid2(box_of(records[i])), least), most), i);
    for (uint32_t i = count; i < kSmall; ++i) key[i] = tag_all(most, i);
    put_in_order(key[0], key[1]);
    put_in_order(key[2], key[3]);
    put_in_order(key[0], key[2]);
    put_in_order(key[1], key[3]);
    put_in_order(key[1], key[2]);
    if (count > 4) {
        put_in_order(key[4], key[5]);
        put_in_order(key[6], key[7]);
        put_in_order(key[4], key[6]);
        put_in_order(key[5], key[7]);
        put_in_order(key[5], key[6]);
        for (uint32_t i = 0; i < 4; ++i) put_in_order(key[i], key[4 + i]);
        for (uint32_t i = 2; i < 4; ++i) put_in_order(key[i], key[2 + i]);
        for (uint32_t i = 1; i < 7; i += 2) put_in_order(key[i], key[1 + i]);
    }
    for (uint32_t k = 0; k < count; ++k) store_tags(order[k], key[k]);
}

// Finds the best split of 2 <= count <= kSmall records. `range` is the box of all of them, and `area` is made from it.
inline void split_small(const Record* records, uint32_t count, const Bounds& range, const AreaScale& area, SmallSplit& split) {
    sort_small(records, count, split.order);
    // Map the boxes to the unit cube, so that the areas need neither a scale nor a sign.
    const Vec4 corner = xyz(load(range.lo));
    const Box8 base = point(corner), scale = join(area.scale, area.scale);
    Box8 unit[kSmall];
    for (uint32_t i = 0; i < count; ++i) unit[i] = (box_of(records[i]) - base) * scale;
    const auto areas = [&](const Box8 box[3]) {
        return half_areas_of(low(box[0]) + neg_high(box[0]) - area.pad, low(box[1]) + neg_high(box[1]) - area.pad,
                             low(box[2]) + neg_high(box[2]) - area.pad);
    };
    Vec4 right_area[kSmall];
    Box8 box[3] = {no_box(), no_box(), no_box()};
    for (uint32_t k = count - 1; k > 0; --k) {
        for (int axis = 0; axis < 3; ++axis) box[axis] = min(box[axis], unit[split.order[k][axis]]);
        right_area[k] = areas(box);
    }
    for (int axis = 0; axis < 3; ++axis) box[axis] = no_box();
    Vec4 best_cost = splat(INFINITY), best_count = splat(0.0f);
    for (uint32_t k = 1; k < count; ++k) {
        for (int axis = 0; axis < 3; ++axis) box[axis] = min(box[axis], unit[split.order[k - 1][axis]]);
        const Vec4 cost =
            areas(box) * splat(static_cast<float>(k)) + right_area[k] * splat(static_cast<float>(count - k));
        keep_less(cost, splat(static_cast<float>(k)), best_cost, best_count);
    }
    alignas(16) float costs[4], counts[4];
    store(costs, best_cost);
    store(counts, best_count);
    for (uint32_t axis = 0; axis < 3; ++axis)
        if (costs[axis] < split.cost) {
            split.cost = costs[axis];
            split.axis = axis;
            split.left_count = static_cast<uint32_t>(counts[axis]);
        }
}

}  // namespace CLARITY_BVH_ISA
}  // namespace clarity::bvh
