// assemble.hpp -- makes a topology of the binary tree of a builder of your own.
#pragma once
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// A node of such a tree, as simple as can be. 32 bytes.
struct TreeNode {
    float lo[3];
    uint32_t left;  // inner node: index of a child. Leaf: position of its first ref
    float hi[3];
    uint32_t right;  // inner node: index of the other child. Leaf: kLeaf | number of its refs, 1 or more
};

// The trees of all groups. Nodes may stand in any order, and nodes that no root reaches are ignored.
struct Trees {
    const TreeNode* nodes;
    uint64_t node_count;
    const uint32_t* roots;  // a node for each group, or RT_NONE: the group is empty
    uint32_t group_count;
    const uint32_t* refs;  // of primitives, in any order; leaves may name one several times
    uint64_t ref_count;
};

// No leaf of Trees may have more nodes above it, itself included.
constexpr uint32_t kMostLevels = 256;

// Makes the topology. Only the boxes of leaves are read: those of inner nodes are made from them, so that each holds what is
// below it. Bounds that are NaN or infinite become the farthest finite ones, and bounds in the wrong order are swapped. A leaf
// of more than max_leaf (1..kLeafMax) refs becomes a tree of smaller ones with the same box: that is sound, and slower than
// splitting by place. The child with the larger surface comes first. The refs are written to `refs` in the order of the leaves,
// so that the refs below each node stand together.
//
// Throws std::invalid_argument, with the reason in words for the tree's author, if the trees are none: an index out of range, a
// node with two parents, a leaf without refs or with refs out of range, too many levels or refs. `trees` is read
// during the call only.
Topology assemble(const rt_host* host, const Trees& trees, uint32_t max_leaf, const RefMemory& refs);

}  // namespace clarity::bvh
