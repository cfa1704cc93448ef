#include "moving/on_host/leaf_packer.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "base/parallel_for.hpp"
#include "structures/rows.hpp"

namespace clarity {
namespace {

constexpr uint32_t kLeavesPerTask = 1u << 12;  // leaves that one task looks up
constexpr uint32_t kCornersAhead = 16;         // how many leaves ahead vertices are prefetched

}  // namespace

UninitializedVector<rt_u32> corners_in_leaf_order(const Scene& scene, const AccelData& accel) {
    UninitializedVector<rt_u32> corners(3 * accel.leaf_count);
    const auto* const leaves = static_cast<const rt_packed_prim*>(accel.leaves.data());
    parallel_for(static_cast<uint32_t>((accel.leaf_count + kLeavesPerTask - 1) / kLeavesPerTask), [&](uint32_t c) {
        const uint64_t end = std::min<uint64_t>(accel.leaf_count, uint64_t{kLeavesPerTask} * (c + 1));
        for (uint64_t i = uint64_t{kLeavesPerTask} * c; i < end; ++i) {
            const bool triangle = RT_REF_KIND(leaves[i].ref) == RT_REF_TRIANGLE;
            const size_t source = triangle ? accel.scene.attribute_triangle[RT_REF_INDEX(leaves[i].ref)] : 0;
            for (int k = 0; k < 3; ++k) corners[3 * i + k] = triangle ? scene.triangles[3 * source + k] : 0;
        }
    });
    return corners;
}

GroupOfRef::GroupOfRef(const BuildScene& scene) : triangle_count_(static_cast<rt_u32>(scene.attribute_triangle.size())) {
    for (rt_u32 g = 0; g < scene.groups.size(); ++g) ranges_.push_back({scene.first_ref_of_group[g], g});
    // A group without triangles begins where the next one does, and must come before it: only the world's may have none.
    std::stable_sort(ranges_.begin(), ranges_.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
}

rt_u32 GroupOfRef::find(rt_u32 ref, rt_u32& first, rt_u32& count) const {
    first = ref;
    count = 1;
    if (RT_REF_KIND(ref) != RT_REF_TRIANGLE) return 0;
    auto next =
        std::upper_bound(ranges_.begin(), ranges_.end(), ref, [](rt_u32 r, const Range& range) { return r < range.first; });
    first = std::prev(next)->first;
    count = (next == ranges_.end() ? triangle_count_ : next->first) - first;
    return std::prev(next)->group;
}

LeafPacker::LeafPacker(AccelData& accel, const UninitializedVector<rt_u32>& corners, const float* positions,
                       const GroupOfRef& groups, std::vector<Bounds>& boxes)
    : accel_(accel), corners_(corners.data()), positions_(positions), groups_(groups), boxes_(boxes) {}

int32_t LeafPacker::prims(void* ctx, uint64_t first, uint64_t count, rt_prim* prims) {
    auto& self = *static_cast<LeafPacker*>(ctx);
    if (!prims || count > self.accel_.leaf_count || first > self.accel_.leaf_count - count) return RT_FAILED;
    self.asked_.fetch_add(count, std::memory_order_relaxed);
    self.pack(first, count, prims);
    return RT_OK;
}

void LeafPacker::pack(uint64_t first, uint64_t count, rt_prim* prims) {
    auto* const leaves = static_cast<rt_packed_prim*>(accel_.leaves.data()) + first;
    const rt_u32* const corners = corners_ + 3 * first;
    const float* const positions = positions_;
    const Row far = Row{} + FLT_MAX;
    Row all_lo = far, all_hi = -far;
    rt_u32 group = RT_NONE, ref_first = 0, ref_count = 0;
    for (uint64_t i = 0; i < count; ++i) {
        const rt_u32* const ahead = corners + 3 * std::min<uint64_t>(i + kCornersAhead, count - 1);
        for (int k = 0; k < 3; ++k) __builtin_prefetch(positions + 3 * size_t(ahead[k]));
        const rt_u32 ref = leaves[i].ref;
        if (__builtin_expect(ref - ref_first >= ref_count, 0)) {
            const rt_u32 next = groups_.find(ref, ref_first, ref_count);
            if (next != group) {
                add(group, all_lo, all_hi);
                all_lo = far;
                all_hi = -far;
                group = next;
            }
        }
        Row lo, hi, name;
        if (__builtin_expect(RT_REF_KIND(ref) == RT_REF_TRIANGLE, 1)) {
            float* const leaf = leaves[i].a;
            name = load_row(leaf);
            const Row a = load_row(positions + 3 * size_t(corners[3 * i])),
                      b = load_row(positions + 3 * size_t(corners[3 * i + 1])),
                      c = load_row(positions + 3 * size_t(corners[3 * i + 2]));
            store_row(leaf, named_as(a, name));
            store_row(leaf + 4, named_as(b, load_row(leaf + 4)));
            store_row(leaf + 8, named_as(c, load_row(leaf + 8)));
            lo = least(least(a, b), c);
            hi = most(most(a, b), c);
        } else {
            pack_other(leaves[i], lo, hi, name);
        }
        // A transform may have made a coordinate infinite or no number: the box is then as large as it can be.
        lo = least(most(lo, -far), far);
        hi = most(least(hi, far), -far);
        all_lo = least(lo, all_lo);
        all_hi = most(hi, all_hi);
        store_row(prims[i].lo, named_as(lo, name));
        store_row(prims[i].hi, named_as(hi, Row{}));
    }
    add(group, all_lo, all_hi);
}

// A primitive that is no triangle: its box.
void LeafPacker::pack_other(rt_packed_prim& leaf, Row& lo, Row& hi, Row& name) const {
    if (RT_REF_KIND(leaf.ref) == RT_REF_INSTANCE) leaf = accel_.scene.instance_leaves[RT_REF_INDEX(leaf.ref)];
    const rt_prim box = box_of(accel_.scene, leaf);
    name = load_row(box.lo);
    lo = least(name, load_row(box.hi));
    hi = most(name, load_row(box.hi));
}

void LeafPacker::add(rt_u32 group, Row lo, Row hi) {
    if (group == RT_NONE) return;
    float bounds[8];
    store_row(bounds, lo);
    store_row(bounds + 4, hi);
    const std::lock_guard<std::mutex> lock(mutex_);
    boxes_[group].add(bounds);
    boxes_[group].add(bounds + 4);
}

}  // namespace clarity
