#include "node_slots.hpp"

#include <algorithm>
#include <cmath>

namespace bvh4 {
namespace {

constexpr uint32_t kWidth = 4;

// Assigns slots greedily. Bit 0 of a slot means the high side in x, bit 1 the high side in y. The best pair of all remaining
// children and slots is assigned first; a child suits a slot better the farther it lies towards that side.
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]) {
    double at[kWidth][2], middle[2] = {0, 0};  // twice the centres; doubles, so that nothing overflows
    for (uint32_t i = 0; i < count; ++i)
        for (int a = 0; a < 2; ++a) {
            at[i][a] = double{children[i].box[a]} + children[i].box[3 + a];
            middle[a] += at[i][a] / count;
        }
    bool placed[kWidth] = {}, taken[kWidth] = {};
    for (uint32_t left = count; left > 0; --left) {
        uint32_t child = 0, slot = 0;
        double best = -INFINITY;
        for (uint32_t i = 0; i < count; ++i)
            for (uint32_t s = 0; s < kWidth; ++s) {
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

void write_node(WideNode& node, const Slot children[], const uint32_t code[], uint32_t count) {
    uint32_t slot_of[kWidth];
    assign_slots(children, count, slot_of);
    for (int k = 0; k < 6; ++k) std::fill_n(node.plane[k], kWidth, k < 3 ? INFINITY : -INFINITY);
    std::fill_n(node.child, kWidth, clarity::bvh::kEmpty);
    std::fill_n(node.pad, 4, 0u);
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 6; ++k) node.plane[k][slot_of[i]] = children[i].box[k];
        node.child[slot_of[i]] = code[i];
    }
}

}  // namespace bvh4
