// collapse.hpp -- which nodes of a binary tree become nodes of the wide one: the cheapest choice by the surface area heuristic,
// found by dynamic programming from the leaves up (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
// Through Compressed Wide BVHs", section 3). Subtrees are decided by the threads that built them, while caches hold them.
#pragma once
#include "builder.hpp"
#include "rt_plugin.h"
// after rt_types.h, whose types it uses:
#include "bvh8_types.h"

namespace bvh8 {

// What the wide tree costs a ray: a node, however many children it has, and a primitive.
struct Costs {
    float node, primitive;
    uint32_t max_leaf;
};

// What stands in a slot of a wide node.
struct Slot {
    const float* box;  // lo, hi; a seventh number may be read
    rt_u32 leaf;       // BVH8_EMPTY: it is a node, that of:
    rt_u32 binary;     // node of the binary tree
};

// What was decided about a binary node stands in the node itself, in the places that its layout leaves free:
//   pad0  position of the first primitive below, in leaf order
//   pad1  bits 3 (i - 2) .. +2, i = 2..8: of i roots to be had from it, how many the left child has; 0: no better than i - 1
//         bits 21..23: primitives below, if they may be one leaf, else 0;  bit 24: one root is that leaf;  bit 25: above tasks
struct Decision {
    static constexpr rt_u32 kIsLeaf = 1u << 24, kIsTop = 1u << 25;
    static uint32_t left_of(rt_u32 bits, uint32_t roots) { return bits >> 3 * (roots - 2) & 7; }
    static uint32_t count(rt_u32 bits) { return bits >> 21 & 7; }
};

// What is below a binary node can be had as at most i + 1 roots for cost[i]. Costs are relative to the group's root box, whose
// longest side is taken as 1.
struct RootCosts {
    float cost[bvh2::kRoots];  // of BVH8_WIDTH in use the last one is that of one root less, for a whole vector
};

class Collapse {
 public:
    // Of trees whose nodes and their costs stand at the same places.
    Collapse(bvh2_node* nodes, RootCosts* root_costs, const Costs& costs)
        : nodes_(nodes), root_costs_(root_costs), kernels_(bvh2::kernels()), costs_(costs) {}

    // For every task as soon as it is built, on any thread.
    void decide_task(const bvh2::Task& task) const;
    // Then for what is above them.
    void decide_tops(const bvh2::BinaryTree& tree) const;
    // For one node, after its children. scale: see bvh2::Task.
    void decide(rt_u32 binary, float scale, rt_u32 more_bits) const;

    // The children of the wide node that a binary node becomes; returns how many.
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
