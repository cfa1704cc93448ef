// collapse.hpp -- decides which nodes of a binary tree become nodes of the wide tree. It finds the cheapest choice by the
// surface area heuristic, by dynamic programming from the leaves up (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray
// Traversal on GPUs Through Compressed Wide BVHs", section 3). The thread that built a subtree also decides it, while its
// caches hold the nodes.
#pragma once
#include "builder.hpp"
#include "rt_plugin.h"
// needs the types of rt_types.h, so it must follow the headers above:
#include "bvh8_types.h"

namespace bvh8 {

// The costs of the wide tree to a ray: of a node (whatever its number of children) and of a primitive.
struct Costs {
    float node, primitive;
    uint32_t max_leaf;
};

// One child of a wide node: a leaf or a node.
struct Slot {
    const float* box;  // lo.xyz, hi.xyz; a seventh number may be read
    rt_u32 leaf;       // BVH8_EMPTY: the child is a node, made from `binary`
    rt_u32 binary;     // index of a node of the binary tree
};

// The decision about a binary node. It is stored in the node's own padding:
//   pad0  position of the first primitive below, in leaf order
//   pad1  three bits from bit 3 (i - 2) on, for i = 2..8: how many of i roots come from the left child;
//             0: i roots are no cheaper than i - 1
//         bits 21..23: number of primitives below, if they may form one leaf, else 0
//         bit 24: the cheapest single root is that leaf
//         bit 25: the node is above the tasks
struct Decision {
    static constexpr rt_u32 kIsLeaf = 1u << 24, kIsTop = 1u << 25;
    static uint32_t left_of(rt_u32 bits, uint32_t roots) { return bits >> 3 * (roots - 2) & 7; }
    static uint32_t count(rt_u32 bits) { return bits >> 21 & 7; }
};

// cost[i] is the cost of the subtree below a binary node if it is cut into at most i + 1 roots. The unit of area is the square
// of the longest side of the group's box.
struct RootCosts {
    float cost[bvh2::kRoots];  // padded to a whole vector: entry BVH8_WIDTH - 1 repeats the one before
};

class Collapse {
 public:
    // The arrays must have the same order: root_costs[i] belongs to nodes[i]. Both must outlive this object.
    Collapse(bvh2_node* nodes, RootCosts* root_costs, const Costs& costs)
        : nodes_(nodes), root_costs_(root_costs), kernels_(bvh2::kernels()), costs_(costs) {}

    // Decides all nodes of a task. Call it for every task after its build, on any thread.
    void decide_task(const bvh2::Task& task) const;
    // Decides the nodes above the tasks. Call it after decide_task() of all tasks.
    void decide_tops(const bvh2::BinaryTree& tree) const;
    // Decides one node. Its children must be decided already. `scale` is as in bvh2::Task.
    void decide(rt_u32 binary, float scale, rt_u32 more_bits) const;

    // Lists the children of the wide node that is made from a binary node, and returns their number.
    uint32_t children(rt_u32 binary, Slot slots[BVH8_WIDTH]) const;
    bool is_above_tasks(rt_u32 binary) const { return nodes_[binary].pad1 & Decision::kIsTop; }

 private:
    void gather(const float* box, rt_u32 code, uint32_t roots, Slot*& next) const;

    bvh2_node* const nodes_;
    RootCosts* const root_costs_;
    const bvh2::Kernels& kernels_;
    const Costs costs_;
};

}  // namespace bvh8
