// binary_tree.hpp -- the binary tree that is collapsed: bvh2's, taken from its builder instead of given to the host.
#pragma once
#include <vector>

#include "partition.hpp"
#include "rt_plugin.h"
#include "scratch.hpp"
// after rt_types.h, whose types it uses:
#include "bvh2_types.h"

namespace bvh8 {

struct BinaryTree {
    bvh2::Scratch<bvh2_node> nodes;  // of all groups; those of a subtree stand in one piece, the root first
    rt_u32 node_count;
    std::vector<rt_u32> roots;  // of groups, ascending
    rt_u32 end_of(size_t group) const { return group + 1 < roots.size() ? roots[group + 1] : node_count; }
};

// Writes the leaf order to `out`; the primitives below any node of the tree lie side by side in it. Reports progress from 0 to
// `share`.
BinaryTree build_binary_tree(const rt_host* host, const rt_build_input& input, const rt_build_output* out,
                             const bvh2::Rules& rules, uint64_t primitive_count, float share);

// Of building it, and of holding it.
uint64_t binary_tree_bytes(uint64_t primitive_count);

}  // namespace bvh8
