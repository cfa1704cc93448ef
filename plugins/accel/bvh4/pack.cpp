#include "pack.hpp"

#include <algorithm>
#include <cmath>

#include "clarity_bvh/parameters.hpp"
#include "clarity_bvh/wide/wide_build.hpp"
#include "clarity_bvh/wide/wide_node.hpp"
#include "node_memory.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {
namespace {

using namespace clarity::bvh;

// Chooses the slot of each child in a node, and writes the node. With four slots, the order that packets use
// (by direction signs) covers two axes.

using WideNode = clarity::bvh::WideNode<4>;

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

// Writes a whole node; a WideLayout::write. Bits 0 and 1 of a child's slot tell on which side of the node it lies in x and y.
// The box of an empty slot reaches from +inf to -inf.
void write_node(WideNode& node, const Slot children[], const uint32_t code[], uint32_t count) {
    uint32_t slot_of[kWidth];
    assign_slots(children, count, slot_of);
    for (int k = 0; k < 6; ++k) std::fill_n(node.plane[k], kWidth, k < 3 ? INFINITY : -INFINITY);
    std::fill_n(node.child, kWidth, kEmpty);
    std::fill_n(node.pad, 4, 0u);
    for (uint32_t i = 0; i < count; ++i) {
        for (int k = 0; k < 6; ++k) node.plane[k][slot_of[i]] = children[i].box[k];
        node.child[slot_of[i]] = code[i];
    }
}

constexpr WideLayout<4> kLayout{write_node, settle};
static_assert(BVH4_EMPTY == kEmpty && BVH4_MAKE_LEAF(5u, 3u) == make_leaf(5, 3), "the library's codes of children");

void finish(const WideBuild& wide, const rt_build_output* out) {
    report(out, wide, uint64_t{wide.nodes} * sizeof(bvh4_node));
    rt::define(out, "BVH4_STACK", stack_places(wide.stack));
}

}  // namespace

void pack(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
          const rt_build_output* out) {
    std::copy_n(refs, topology.ref_count, rt::leaves(out, topology.ref_count));
    finish(pack_wide(host, topology, input.groups, input.group_count, wide_costs(wide_rules(input.params)), kLayout,
                     host_nodes<bvh4_node, 4>(out)),
           out);
}

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out) {
    finish(build_wide(host, *input, wide_rules(input->params), kLayout, host_refs(out), host_nodes<bvh4_node, 4>(out)), out);
    return RT_OK;
}

}  // namespace bvh4
