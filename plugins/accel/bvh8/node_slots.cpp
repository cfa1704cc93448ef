#include "node_slots.hpp"

#include <algorithm>
#include <cfloat>

namespace bvh8 {
namespace {

using bvh2::Vec4;

// Assigns slots greedily. Slot s stands for a corner of the node: coordinate k is at its high end if bit k of s is set. The
// best pair of all remaining children and corners is assigned first; a child suits a corner better the farther it lies towards
// it.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    const Vec4 small = bvh2::splat(0.0625f);  // scales the boxes so that no sum below overflows
    const Vec4 share = bvh2::splat(1.0f / static_cast<float>(count));
    Vec4 center[BVH8_WIDTH], middle = bvh2::splat(0.0f);
    for (uint32_t i = 0; i < count; ++i) {
        center[i] = bvh2::load_any(children[i].box) * small + bvh2::load_any(children[i].box + 3) * small;
        middle = middle + center[i] * share;
    }
    alignas(16) const float signs_x[4] = {-1, 1, -1, 1}, signs_y[4] = {-1, -1, 1, 1};
    const Vec4 sign_x = bvh2::load(signs_x), sign_y = bvh2::load(signs_y);
    bvh2::Suits suits[BVH8_WIDTH];
    static_assert(BVH8_WIDTH == bvh2::kPlaces && bvh2::kPlaces * bvh2::kPlaces <= bvh2::kTags, "a tag names child and slot");
    for (uint32_t i = 0; i < count; ++i) {
        alignas(16) float at[4];
        bvh2::store(at, center[i] - middle);
        const Vec4 xy = sign_x * bvh2::splat(at[0]) + sign_y * bvh2::splat(at[1]), z = bvh2::splat(at[2]);
        bvh2::store(suits[i].place, bvh2::tag_lanes(xy - z, BVH8_WIDTH * i));
        bvh2::store(suits[i].place + 4, bvh2::tag_lanes(xy + z, BVH8_WIDTH * i + 4));
    }
    static const bvh2::Kernels& kernels = bvh2::kernels();
    kernels.assign_places(suits, count, slot_of);
}

}  // namespace

void write_node(bvh8_node& node, const Slot children[], const rt_u32 code[], uint32_t count) {
    uint32_t slot_of[BVH8_WIDTH];
    assign_slots(children, count, slot_of);
    for (auto& row : node.plane) std::fill_n(row, BVH8_WIDTH, FLT_MAX);
    std::fill_n(node.child, BVH8_WIDTH, BVH8_EMPTY);
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 6; ++k) node.plane[k][slot_of[i]] = children[i].box[k];
        node.child[slot_of[i]] = code[i];
    }
}

}  // namespace bvh8
