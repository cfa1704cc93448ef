// binning.inl -- the surface area heuristic over bins (Wald 2007, "On fast Construction of SAH-based Bounding Volume
// Hierarchies"). The extent of the centroids is cut into equal slices on all three axes at once, and the primitives of each
// slice are counted and bounded. Only the planes between slices are split candidates. A node takes one pass over its
// primitives, whatever their number.
// Each kernels*.cpp includes this file once, for its instruction set.

namespace clarity::bvh {
namespace CLARITY_BVH_ISA {

void clear(Bins& bins, uint32_t bin_count) {
    for (uint32_t b = 0; b < bin_count; ++b)
        for (int axis = 0; axis < 3; ++axis) store_box(bins.box[b][axis], no_box());
    std::memset(bins.count, 0, bin_count * sizeof bins.count[0]);
}

inline void bin_one(const Record& record, const Slices& slices, Bins& bins) {
    const Box8 box = box_of(record);
    uint32_t b[3];
    to_index(slices.position(centroid2(box)), b);
    for (int axis = 0; axis < 3; ++axis) {
        Bounds& at = bins.box[b[axis]][axis];
        store_box(at, min(load_box(at), box));
        ++bins.count[b[axis]][axis];
    }
}

void merge(const Bins& from, uint32_t bin_count, Bins& to) {
    for (uint32_t b = 0; b < bin_count; ++b) {
        for (int axis = 0; axis < 3; ++axis)
            store_box(to.box[b][axis], min(load_box(to.box[b][axis]), load_box(from.box[b][axis])));
        store_counts(to.count[b], load_counts(to.count[b]) + load_counts(from.count[b]));
    }
}

// Neighbouring records often fall into the same slice, and then each must wait until the box that the last one stored can be
// loaded. Long ranges therefore write to four sets of bins in rotation. Measured on an Intel Sapphire Rapids where records
// share slices: one or two sets take 10 ns a record, four take 3.5 ns.
constexpr ptrdiff_t kSets = 4, kManyForSets = 512;

void bin(const Record* first, const Record* end, const Slices& slices, Bins& bins) {
    const Slices place = slices;  // a local copy: stays in registers while the bins are written
    const Record* r = first;
    if (end - first >= kManyForSets) {
        Bins others[kSets - 1];
        for (Bins& other : others) clear(other, place.count);
        for (; end - r >= kSets; r += kSets) {
            fetch(r + kStreamAhead);
            fetch(r + kStreamAhead + 2);
            bin_one(r[0], place, bins);
            for (ptrdiff_t i = 1; i < kSets; ++i) bin_one(r[i], place, others[i - 1]);
        }
        for (const Bins& other : others) merge(other, place.count, bins);
    }
    for (; r != end; ++r) bin_one(*r, place, bins);
}

void find_split(const Bins& bins, uint32_t bin_count, const AreaScale& area, uint32_t primitive_count, Split& split) {
    // Sweep from the right: right_area[b] is the area of everything at or right of plane b.
    Vec4 right_area[kMaxBins];
    Box8 box[3] = {no_box(), no_box(), no_box()};
    for (uint32_t b = bin_count - 1; b > 0; --b) {
        for (int axis = 0; axis < 3; ++axis) box[axis] = min(box[axis], load_box(bins.box[b][axis]));
        right_area[b] = half_areas(area, box);
    }
    // Sweep from the left and compute the cost of each plane. The area of a side without primitives is NaN or infinite; times 0
    // primitives the cost is NaN, so such a plane never wins.
    for (int axis = 0; axis < 3; ++axis) box[axis] = no_box();
    alignas(16) const uint32_t none[4] = {0, 0, 0, 0};
    Count4 left = load_counts(none);
    const Vec4 all = splat(static_cast<float>(primitive_count));
    Vec4 best_cost = splat(INFINITY), best_bin = splat(0.0f);
    for (uint32_t b = 1; b < bin_count; ++b) {
        for (int axis = 0; axis < 3; ++axis) box[axis] = min(box[axis], load_box(bins.box[b - 1][axis]));
        left = left + load_counts(bins.count[b - 1]);
        const Vec4 left_f = to_float(left);
        const Vec4 cost = half_areas(area, box) * left_f + right_area[b] * (all - left_f);
        keep_less(cost, splat(static_cast<float>(b)), best_cost, best_bin);
    }
    alignas(16) float costs[4], planes[4];
    store(costs, best_cost);
    store(planes, best_bin);
    for (int axis = 0; axis < 3; ++axis)
        if (costs[axis] < split.cost) {
            split.cost = costs[axis];
            split.axis = axis;
            split.bin = static_cast<uint32_t>(planes[axis]);
        }
    if (split.bin == 0) return;
    Box8 side[2] = {no_box(), no_box()};
    for (uint32_t b = 0; b < split.bin; ++b) {
        side[0] = min(side[0], load_box(bins.box[b][split.axis]));
        split.left_count += bins.count[b][split.axis];
    }
    for (uint32_t b = split.bin; b < bin_count; ++b) side[1] = min(side[1], load_box(bins.box[b][split.axis]));
    store_box(split.left, side[0]);
    store_box(split.right, side[1]);
}

void scatter(const Record* first, const Record* end, const Slices& slices, const Split& split, Record* left, Record* right,
             Bounds& left_centroids2, Bounds& right_centroids2) {
    alignas(16) float base_of[4], scale_of[4];
    store(base_of, slices.base);
    store(scale_of, slices.scale);
    const Box8 base = all_eight(base_of[split.axis]), scale = all_eight(scale_of[split.axis]),
               plane = all_eight(static_cast<float>(split.bin));
    Box8 l = load_box(left_centroids2), r = load_box(right_centroids2);
    // Byte addresses of the next left and right record. The destination is selected by arithmetic, because a branch would be
    // mispredicted half of the time.
    char* to_left = reinterpret_cast<char*>(left);
    char* to_right = reinterpret_cast<char*>(right);
    for (const Record* at = first; at != end; ++at) {
        fetch(at + kStreamAhead);
        const Box8 centroid = centroid2_box(box_of(*at));
        // bin() truncates the position to an integer and clamps it to the last slice. Since `plane` is an integer, position <
        // plane gives the same side as trunc(position) < plane, with or without the clamp.
        const Box8 is_left = less((lane_in_all(centroid, split.axis) - base) * scale, plane);
        l = min_where(is_left, centroid, l);
        r = min_unless(is_left, centroid, r);
        const uint32_t goes_left = first_of(is_left);
        copy(reinterpret_cast<Record*>(to_right + ((to_left - to_right) & -static_cast<ptrdiff_t>(goes_left))), *at);
        to_left += sizeof(Record) * goes_left;
        to_right += sizeof(Record) * (goes_left ^ 1u);
    }
    store_box(left_centroids2, l);
    store_box(right_centroids2, r);
}

}  // namespace CLARITY_BVH_ISA
}  // namespace clarity::bvh
