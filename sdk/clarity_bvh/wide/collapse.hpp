// collapse.hpp -- decides which nodes of a binary tree become nodes of the wide tree. It finds the cheapest choice by the
// surface area heuristic, by dynamic programming from the leaves up (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray
// Traversal on GPUs Through Compressed Wide BVHs", section 3). The thread that built a part may also decide it, while its
// caches hold the nodes.
#pragma once
#include "clarity_bvh/kernels/kernels.hpp"
#include "clarity_bvh/wide/wide_node.hpp"

namespace clarity::bvh {

// The costs of the wide tree to a ray: of a node (whatever its number of children) and of a primitive.
struct Costs {
    float node, primitive;
    uint32_t max_leaf;
};
inline Costs wide_costs(const Rules& rules) {
    return {rules.traversal_cost, rules.intersection_cost, rules.max_leaf};
}

// The decision about a binary node. It is stored in the node's own words for the packer:
//   work0 position of the first primitive below, in leaf order
//   work1 three bits from bit 3 (i - 2) on, for i = 2..8: how many of i roots come from the left child;
//             0: i roots are no cheaper than i - 1
//         bits 21..23: number of primitives below, if they may form one leaf, else 0
//         bit 24: the cheapest single root is that leaf
//         bit 25: the node is above the parts
struct Decision {
    static constexpr uint32_t kIsLeaf = 1u << 24, kIsTop = 1u << 25;
    static uint32_t left_of(uint32_t bits, uint32_t roots) { return bits >> 3 * (roots - 2) & 7; }
    static uint32_t primitives(uint32_t bits) { return bits >> 21 & 7; }
};

// cost[i] is the cost of the subtree below a binary node if it is cut into at most i + 1 roots. The unit of area is the square
// of the longest side of the group's box.
struct RootCosts {
    float cost[kRoots];  // padded to a whole vector: entry Width - 1 repeats the one before
};

// Collapses a topology to nodes of up to Width children: 4 or 8.
template <uint32_t Width>
class Collapse {
 public:
    // The arrays must have the same order: root_costs[i] belongs to nodes[i]. Both must outlive this object.
    Collapse(Node* nodes, RootCosts* root_costs, const Costs& costs)
        : nodes_(nodes), root_costs_(root_costs), kernels_(kernels()), costs_(costs) {}

    // Decides all nodes of a part. Call it for every part after its build, on any thread.
    void decide_part(const Part& part) const;
    // Decides the nodes above the parts. Call it after decide_part() of all parts.
    void decide_tops(const Topology& topology) const;
    // Decides one node. Its children must be decided already. `scale` is as in Part.
    void decide(uint32_t binary, float scale, uint32_t more_bits) const;

    // Lists the children of the wide node that is made from a binary node, and returns their number.
    uint32_t children(uint32_t binary, Slot slots[Width]) const;
    bool is_above_parts(uint32_t binary) const { return nodes_[binary].work1 & Decision::kIsTop; }

 private:
    void gather(const float* box, uint32_t code, uint32_t roots, Slot*& next) const;

    Node* const nodes_;
    RootCosts* const root_costs_;
    const Kernels& kernels_;
    const Costs costs_;
};
extern template class Collapse<4>;
extern template class Collapse<8>;

}  // namespace clarity::bvh
