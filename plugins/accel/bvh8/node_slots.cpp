#include "node_slots.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace bvh8 {
namespace {

// Slot s is the corner of the node whose coordinate k is high where bit k of s is set. Of all children and corners left over,
// the pair goes together whose child lies farthest towards its corner.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    constexpr float kSmall = 0.0625f;  // no sum below overflows
    float center[BVH8_WIDTH][3], middle[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; ++i)
        for (int a = 0; a < 3; ++a) {
            center[i][a] = kSmall * children[i].box[a] + kSmall * children[i].box[3 + a];
            middle[a] += center[i][a] / static_cast<float>(count);
        }
    float fit[BVH8_WIDTH][BVH8_WIDTH];
    uint32_t best_slot[BVH8_WIDTH];  // of those that are open
    const auto find_best = [&](uint32_t child, uint32_t open) {
        float best = -INFINITY;
        for (uint32_t s = 0; s < BVH8_WIDTH; ++s)
            if ((open >> s & 1) && fit[child][s] > best) {
                best = fit[child][s];
                best_slot[child] = s;
            }
    };
    for (uint32_t i = 0; i < count; ++i) {
        const float x = center[i][0] - middle[0], y = center[i][1] - middle[1], z = center[i][2] - middle[2];
        for (uint32_t s = 0; s < BVH8_WIDTH; ++s) fit[i][s] = (s & 1 ? x : -x) + (s & 2 ? y : -y) + (s & 4 ? z : -z);
        best_slot[i] = (x > 0 ? 1 : 0) | (y > 0 ? 2 : 0) | (z > 0 ? 4 : 0);
    }
    uint32_t open = (1u << BVH8_WIDTH) - 1, left[BVH8_WIDTH];
    for (uint32_t i = 0; i < count; ++i) left[i] = i;
    for (uint32_t n = count; n > 0;) {
        uint32_t at = 0;
        for (uint32_t i = 1; i < n; ++i)
            if (fit[left[i]][best_slot[left[i]]] > fit[left[at]][best_slot[left[at]]]) at = i;
        const uint32_t slot = best_slot[left[at]];
        slot_of[left[at]] = slot;
        open &= ~(1u << slot);
        left[at] = left[--n];
        for (uint32_t i = 0; i < n; ++i)
            if (best_slot[left[i]] == slot) find_best(left[i], open);
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
