// collapse.hpp -- which nodes of a binary tree become nodes of the wide one: the cheapest choice by the surface area heuristic,
// found by dynamic programming from the leaves up (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs
// Through Compressed Wide BVHs", section 3).
#pragma once
#include "binary_tree.hpp"
#include "rt_plugin.h"
// after rt_types.h, whose types it uses:
#include "bvh8_types.h"

namespace bvh8 {

// What the wide tree costs a ray: a node, however many children it has, and a primitive.
struct Costs {
    float node, primitive;
    uint32_t max_leaf;
};

struct Span {
    rt_u32 begin, end;  // nodes of the binary tree
};

// A child as the binary tree has it: its box, and a node or a leaf of that tree.
struct Child {
    const float* box;
    rt_u32 code;
};
// What stands in a slot of a wide node.
struct Slot {
    const float* box;
    rt_u32 leaf;    // BVH8_NOTHING: it is a node, that of:
    rt_u32 binary;  // node of the binary tree
};

class Collapse {
 public:
    // Decides about all of the tree. `tree` must outlive this.
    Collapse(const rt_host* host, const BinaryTree& tree, const Costs& costs);

    // The children of the wide node that a binary node becomes; returns how many.
    uint32_t children(rt_u32 binary, Slot slots[BVH8_WIDTH]) const;

    // The tree falls into small subtrees, one thread's task each, and the few nodes above them.
    bool is_above_tasks(rt_u32 binary) const;
    const BinaryTree& tree() const { return tree_; }

 private:
    // For a binary node: what is below it can be had as at most i + 1 roots for cost[i]. The costs are those of the group's
    // root box, whose longest side is taken as 1.
    struct Choice {
        float cost[BVH8_WIDTH - 1];
        uint8_t left[BVH8_WIDTH + 1];  // of i roots, how many are the left child's; 0: no better than i - 1
        uint8_t count;                 // primitives, if they may be one leaf, else 0
        uint8_t is_leaf;               // one root: that leaf
        rt_u32 first;                  // position of the first primitive below
    };

    void cut(size_t group);
    void decide(rt_u32 binary, double scale);
    void gather(const Child& child, uint32_t roots, Slot*& next) const;

    const BinaryTree& tree_;
    const Costs costs_;
    bvh2::Scratch<Choice> choices_;
    std::vector<Span> tasks_;     // ascending
    std::vector<double> scales_;  // of tasks
    struct Top {
        rt_u32 node;
        double scale;
    };
    std::vector<Top> top_;  // nodes above the tasks, parents first
};

}  // namespace bvh8
