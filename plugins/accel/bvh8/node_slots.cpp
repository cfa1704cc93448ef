#include "node_slots.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace bvh8 {

// Slot s is the corner of the node whose coordinate k is high where bit k of s is set. Of all children and corners left over,
// the pair goes together whose child lies farthest towards its corner.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    double fit[BVH8_WIDTH][BVH8_WIDTH];
    double middle[3] = {0, 0, 0};
    for (uint32_t i = 0; i < count; ++i)
        for (int a = 0; a < 3; ++a) middle[a] += (double{children[i].box[a]} + children[i].box[3 + a]) / count;
    for (uint32_t i = 0; i < count; ++i) {
        double d[3];
        for (int a = 0; a < 3; ++a) d[a] = double{children[i].box[a]} + children[i].box[3 + a] - middle[a];
        for (uint32_t s = 0; s < BVH8_WIDTH; ++s)
            fit[i][s] = (s & 1 ? d[0] : -d[0]) + (s & 2 ? d[1] : -d[1]) + (s & 4 ? d[2] : -d[2]);
    }
    uint32_t open_children = (1u << count) - 1, open_slots = (1u << BVH8_WIDTH) - 1;
    while (open_children != 0) {
        double best = -INFINITY;
        uint32_t best_child = 0, best_slot = 0;
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t s = 0; s < BVH8_WIDTH; ++s)
                if ((open_children >> i & 1) && (open_slots >> s & 1) && fit[i][s] > best) {
                    best = fit[i][s];
                    best_child = i;
                    best_slot = s;
                }
        slot_of[best_child] = best_slot;
        open_children &= ~(1u << best_child);
        open_slots &= ~(1u << best_slot);
    }
}

void clear_node(bvh8_node& node) {
    for (auto& row : node.plane) std::fill_n(row, BVH8_WIDTH, FLT_MAX);
    std::fill_n(node.child, BVH8_WIDTH, BVH8_NOTHING);
}

void set_slot(bvh8_node& node, uint32_t slot, const float box[6], rt_u32 child) {
    for (int k = 0; k < 6; ++k) node.plane[k][slot] = box[k];
    node.child[slot] = child;
}

}  // namespace bvh8
