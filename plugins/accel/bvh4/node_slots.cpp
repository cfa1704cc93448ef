// node_slots.cpp -- chooses the slot of each child in a node. With four slots, the order that packets use (by direction signs)
// covers two axes.
#include "node_slots.hpp"

#include <algorithm>
#include <cmath>

namespace bvh8 {
namespace {

// Assigns slots greedily. Bit 0 of a slot means the high side in x, bit 1 the high side in y. The best pair of all remaining
// children and slots is assigned first; a child suits a slot better the farther it lies towards that side.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    double at[BVH8_WIDTH][2], middle[2] = {0, 0};  // twice the centres; doubles, so that nothing overflows
    for (uint32_t i = 0; i < count; ++i)
        for (int a = 0; a < 2; ++a) {
            at[i][a] = double{children[i].box[a]} + children[i].box[3 + a];
            middle[a] += at[i][a] / count;
        }
    bool placed[BVH8_WIDTH] = {}, taken[BVH8_WIDTH] = {};
    for (uint32_t left = count; left > 0; --left) {
        uint32_t child = 0, slot = 0;
        double best = -INFINITY;
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t s = 0; s < BVH8_WIDTH; ++s) {
                const double x = at[i][0] - middle[0], y = at[i][1] - middle[1], fit = (s & 1 ? x : -x) + (s & 2 ? y : -y);
                if (placed[i] || taken[s] || !(fit > best)) continue;
                best = fit;
                child = i;
                slot = s;
            }
        slot_of[child] = slot;
        placed[child] = taken[slot] = true;
    }
}

}  // namespace

void write_node(bvh8_node& node, const Slot children[], const rt_u32 code[], uint32_t count) {
    uint32_t slot_of[BVH8_WIDTH];
    assign_slots(children, count, slot_of);
    for (int k = 0; k < 6; ++k) std::fill_n(node.plane[k], BVH8_WIDTH, k < 3 ? INFINITY : -INFINITY);
    std::fill_n(node.child, BVH8_WIDTH, BVH8_EMPTY);
    std::fill_n(node.pad, 4, 0u);
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 6; ++k) node.plane[k][slot_of[i]] = children[i].box[k];
        node.child[slot_of[i]] = code[i];
    }
}

}  // namespace bvh8
