// wide_node.hpp -- a node with up to Width children, as packers write it and traversals of wide trees read it.
#pragma once
#include <algorithm>

#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// plane[k] is a row: for k = 0..2 the children's lower bounds in x, y, z, for k = 3..5 the upper ones. Bounds are exact and not
// padded: the traversal accounts for its own rounding. child[] has the codes of topology.hpp; the nodes that they count are
// wide ones. A slot without a child is kEmpty. 224 bytes with 8 children.
template <uint32_t Width>
struct WideNode {
    float plane[6][Width];
    uint32_t child[Width];
};
// 128 bytes, a line of a GPU's cache.
template <>
struct WideNode<4> {
    float plane[6][4];
    uint32_t child[4];
    uint32_t pad[4];
};
static_assert(sizeof(WideNode<8>) == 224 && sizeof(WideNode<4>) == 128, "rows are aligned vectors");

// One child of a wide node while it is packed: a leaf or a node.
struct Slot {
    const float* box;  // lo.xyz, hi.xyz; a seventh number may be read
    uint32_t leaf;     // kEmpty: the child is a node, made from `binary`
    uint32_t binary;   // index of a node of the topology
};

// How a plugin's nodes differ from those of others.
template <uint32_t Width>
struct WideLayout {
    // Writes a whole node: child i of `count` gets the code code[i], and a slot that suits the traversal. Any thread calls it.
    void (*write)(WideNode<Width>& node, const Slot children[], const uint32_t code[], uint32_t count);
    // Converts the finished node `at` to the form that the traversal reads, in place. Null: it reads nodes as they were
    // written.
    void (*settle)(WideNode<Width> nodes[], uint32_t at);
};

// Calls do_one(box, child) for every child of the node, with box[6]: lo.xyz, hi.xyz. Empty slots are skipped.
template <uint32_t Width, class Body>
void each_child(const WideNode<Width>& node, Body&& do_one) {
    for (uint32_t slot = 0; slot < Width; ++slot) {
        if (node.child[slot] == kEmpty) continue;
        float box[6];
        for (int k = 0; k < 6; ++k) box[k] = node.plane[k][slot];
        do_one(box, node.child[slot]);
    }
}

}  // namespace clarity::bvh
