#include "clarity_bvh/wide/octant_slots.hpp"

#include <algorithm>
#include <cfloat>

#include "clarity_bvh/kernels/kernels.hpp"

namespace clarity::bvh {
namespace {

constexpr uint32_t kWidth = 8;

// Assigns slots greedily. Slot s stands for a corner of the node: coordinate k is at its high end if bit k of s is set. The
// best pair of all remaining children and corners is assigned first; a child suits a corner better the farther it lies towards
// it.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    const Vec4 small = splat(0.0625f);  // scales the boxes so that no sum below overflows
    const Vec4 share = splat(1.0f / static_cast<float>(count));
    Vec4 center[kWidth], middle = splat(0.0f);
    for (uint32_t i = 0; i < count; ++i) {
        center[i] = load_any(children[i].box) * small + load_any(children[i].box + 3) * small;
        middle = middle + center[i] * share;
    }
    alignas(16) const float signs_x[4] = {-1, 1, -1, 1}, signs_y[4] = {-1, -1, 1, 1};
    const Vec4 sign_x = load(signs_x), sign_y = load(signs_y);
    Suits suits[kWidth];
    static_assert(kWidth == kPlaces && kPlaces * kPlaces <= kTags, "a tag names child and slot");
    for (uint32_t i = 0; i < count; ++i) {
        alignas(16) float at[4];
        store(at, center[i] - middle);
        const Vec4 xy = sign_x * splat(at[0]) + sign_y * splat(at[1]), z = splat(at[2]);
        store(suits[i].place, tag_lanes(xy - z, kWidth * i));
        store(suits[i].place + 4, tag_lanes(xy + z, kWidth * i + 4));
    }
    static const Kernels& best = kernels();
    best.assign_places(suits, count, slot_of);
}

}  // namespace

void write_octant_node(WideNode<8>& node, const Slot children[], const uint32_t code[], uint32_t count) {
    uint32_t slot_of[kWidth];
    assign_slots(children, count, slot_of);
    for (auto& row : node.plane) std::fill_n(row, kWidth, FLT_MAX);
    std::fill_n(node.child, kWidth, kEmpty);
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 6; ++k) node.plane[k][slot_of[i]] = children[i].box[k];
        node.child[slot_of[i]] = code[i];
    }
}

}  // namespace clarity::bvh
