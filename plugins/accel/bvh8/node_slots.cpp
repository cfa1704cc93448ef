#include "node_slots.hpp"

#include <algorithm>
#include <cfloat>

namespace bvh8 {
namespace {

using bvh2::Vec4;

// How well a child suits slots 0..3 and 4..7, tagged with 8 child + slot.
struct Fit {
    Vec4 low, high;
};

// Slot s is the corner of the node whose coordinate k is high where bit k of s is set. Of all children and corners left over,
// the pair goes together whose child lies farthest towards its corner.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    const Vec4 small = bvh2::splat(0.0625f);  // no sum below overflows
    const Vec4 share = bvh2::splat(1.0f / static_cast<float>(count));
    Vec4 center[BVH8_WIDTH], middle = bvh2::splat(0.0f);
    for (uint32_t i = 0; i < count; ++i) {
        center[i] = bvh2::load_any(children[i].box) * small + bvh2::load_any(children[i].box + 3) * small;
        middle = middle + center[i] * share;
    }
    alignas(16) const float signs_x[4] = {-1, 1, -1, 1}, signs_y[4] = {-1, -1, 1, 1};
    const Vec4 sign_x = bvh2::load(signs_x), sign_y = bvh2::load(signs_y);
    Fit fit[BVH8_WIDTH];
    for (uint32_t i = 0; i < count; ++i) {
        alignas(16) float at[4];
        bvh2::store(at, center[i] - middle);
        const Vec4 xy = sign_x * bvh2::splat(at[0]) + sign_y * bvh2::splat(at[1]), z = bvh2::splat(at[2]);
        fit[i] = {bvh2::tag_lanes(xy - z, BVH8_WIDTH * i), bvh2::tag_lanes(xy + z, BVH8_WIDTH * i + 4)};
    }
    alignas(16) float open[BVH8_WIDTH];  // what no fit exceeds; least for slots that are taken
    std::fill_n(open, BVH8_WIDTH, FLT_MAX);
    alignas(16) float best[4];
    alignas(16) uint32_t tags[4];
    for (uint32_t left = count; left > 0; --left) {
        Vec4 low = fit[0].low, high = fit[0].high;
        for (uint32_t i = 1; i < count; ++i) {
            low = bvh2::max(low, fit[i].low);
            high = bvh2::max(high, fit[i].high);
        }
        const Vec4 both = bvh2::max(bvh2::min(low, bvh2::load(open)), bvh2::min(high, bvh2::load(open + 4)));
        bvh2::store(best, both);
        bvh2::store_tags(tags, both);
        const uint32_t a = best[0] > best[1] ? 0 : 1, b = best[2] > best[3] ? 2 : 3;
        const uint32_t tag = tags[best[a] > best[b] ? a : b], slot = tag % BVH8_WIDTH, child = tag / BVH8_WIDTH;
        slot_of[child] = slot;
        open[slot] = -FLT_MAX;
        fit[child] = {bvh2::splat(-FLT_MAX), bvh2::splat(-FLT_MAX)};
    }
}

}  // namespace

void write_node(bvh8_node& node, const Slot children[], const rt_u32 code[], uint32_t count) {
    uint32_t slot_of[BVH8_WIDTH];
    assign_slots(children, count, slot_of);
    for (auto& row : node.plane) std::fill_n(row, BVH8_WIDTH, FLT_MAX);
    std::fill_n(node.child, BVH8_WIDTH, BVH8_NOTHING);
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 6; ++k) node.plane[k][slot_of[i]] = children[i].box[k];
        node.child[slot_of[i]] = code[i];
    }
}

}  // namespace bvh8
