#include "node_slots.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

namespace bvh8 {

// Slot s is the corner of the node whose coordinate k is high where bit k of s is set. Of all children and corners left over,
// the pair goes together whose child lies farthest towards its corner.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    double center[BVH8_WIDTH][3], middle[3] = {0, 0, 0};  // twice the centres; no float overflows
    for (uint32_t i = 0; i < count; ++i)
        for (int a = 0; a < 3; ++a) {
            center[i][a] = double{children[i].box[a]} + children[i].box[3 + a];
            middle[a] += center[i][a] / count;
        }
    double fit[BVH8_WIDTH][BVH8_WIDTH];
    uint32_t open_children[BVH8_WIDTH], open_slots[BVH8_WIDTH];
    for (uint32_t i = 0; i < count; ++i) {
        const double x = center[i][0] - middle[0], y = center[i][1] - middle[1], z = center[i][2] - middle[2];
        for (uint32_t s = 0; s < BVH8_WIDTH; ++s) fit[i][s] = (s & 1 ? x : -x) + (s & 2 ? y : -y) + (s & 4 ? z : -z);
        open_children[i] = i;
    }
    for (uint32_t s = 0; s < BVH8_WIDTH; ++s) open_slots[s] = s;
    for (uint32_t left = count, slots = BVH8_WIDTH; left > 0;) {
        uint32_t child = 0, slot = 0;
        double best = -INFINITY;
        for (uint32_t i = 0; i < left; ++i)
            for (uint32_t s = 0; s < slots; ++s)
                if (fit[open_children[i]][open_slots[s]] > best) {
                    best = fit[open_children[i]][open_slots[s]];
                    child = i;
                    slot = s;
                }
        slot_of[open_children[child]] = open_slots[slot];
        open_children[child] = open_children[--left];
        open_slots[slot] = open_slots[--slots];
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
