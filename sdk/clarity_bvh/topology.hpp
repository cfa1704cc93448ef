// topology.hpp -- a binary tree over primitives, without any layout for a traversal: what builders produce and what packers
// read.
//
//   builder (build/builder.hpp, or your own through assemble.hpp)  ->  Topology  ->  packer (pack_binary.hpp,
//   wide/wide_build.hpp)
//
// So any builder goes with any layout.
#pragma once
#include <functional>
#include <vector>

#include "clarity_bvh/base/bounds.hpp"
#include "clarity_bvh/base/scratch.hpp"
#include "rt_cost.hpp"

namespace clarity::bvh {

// ---- children ---------------------------------------------------------------------------------------------------------------

// A child is the index of a node, or, with kLeaf set, a leaf. Bits 28..30 of a leaf are the number of its primitives (1..7),
// bits 0..27 the position of the first in leaf order. A position has 28 bits, like the index in an rt_prim's ref.
constexpr uint32_t kLeaf = 0x80000000u, kLeafMax = 7;
// The most primitives of a tree: positions in leaf order are below it.
constexpr uint64_t kMaxPrimitives = RT_REF_INDEX_MAX;
constexpr bool is_leaf(uint32_t child) {
    return (child & kLeaf) != 0;
}
constexpr uint32_t leaf_count(uint32_t child) {
    return child >> 28 & kLeafMax;
}
constexpr uint32_t leaf_first(uint32_t child) {
    return child & 0x0FFFFFFFu;
}
constexpr uint32_t make_leaf(uint32_t first, uint32_t count) {
    return kLeaf | count << 28 | first;
}
// A leaf of no primitives. A topology has none; packers write it where a node of fixed width has no child.
constexpr uint32_t kEmpty = make_leaf(0, 0);

// ---- nodes ------------------------------------------------------------------------------------------------------------------

// A node with the boxes of both children: lo.xyz, hi.xyz, the exact bounds of the primitives below. 64 bytes, one cache line.
// The child with the larger surface comes first where the builder orders them.
struct Node {
    float box0[6];
    uint32_t child0;
    uint32_t work0;  // work0 and work1 are the packer's: builders write 0, and wide/collapse.hpp keeps its decisions there
    float box1[6];
    uint32_t child1;
    uint32_t work1;
};
static_assert(sizeof(Node) == 64, "one cache line");

inline void set_child(Node& node, int which, const Bounds& box, uint32_t child) {
    float* out = which == 0 ? node.box0 : node.box1;
    for (int axis = 0; axis < 3; ++axis) {
        out[axis] = box.lo[axis];
        out[3 + axis] = box.hi(axis);
    }
    (which == 0 ? node.child0 : node.child1) = child;
    (which == 0 ? node.work0 : node.work1) = 0;
}

// ---- the tree ---------------------------------------------------------------------------------------------------------------

// A subtree that one thread built, and that one thread packs. Its nodes stand together, from first_node on, in depth-first
// order: parents come before children. If child 0 of a node is a node, it is the next one.
struct Part {
    uint32_t first_node;      // ascending with the places of the parts in leaf order, also for parts without a node
    float scale;              // unit_scale() of the group's box
    uint32_t root = kEmpty;   // child code: a leaf, or the index of the root node
    uint32_t node_count = 0;  // 0 if the root is a leaf
    uint32_t depth = 0;       // number of nodes on the path from the group's root to the deepest leaf
};
// A node above the parts.
struct Top {
    uint32_t node;
    float scale;  // as in Part
};
// The root of a group's tree: a node or a leaf. The code is RT_NONE if the group is empty.
struct Root {
    Bounds box;
    uint32_t code = RT_NONE;
};

// Gives memory for so many refs, which a builder fills in leaf order. It is called once per build, on the calling thread, and
// must return memory for 0 refs, too. Usually: [&](uint64_t count) { return rt::leaves(out, count); }
using RefMemory = std::function<uint32_t*(uint64_t count)>;

// The trees of all groups. The refs of the primitives in leaf order are not part of it: the builder writes them to a RefMemory,
// usually the host's, which needs them in just that order. The refs below each node stand together.
struct Topology {
    // Child codes are indices into this array. It has gaps between the parts: use parts and tops to walk over all nodes.
    // Movable, not copyable: the nodes of a million primitives are 64 MB.
    Scratch<Node> nodes;
    std::vector<Part> parts;
    std::vector<Top> tops;    // parents before children
    std::vector<Root> roots;  // of groups
    uint64_t ref_count = 0;   // number of refs in leaf order
    uint32_t depth = 1;       // number of nodes on the path from a root to the deepest leaf

    // Number of nodes. Takes a step for each part.
    uint64_t node_count() const;
};

// The quality of a topology.
struct Quality {
    uint64_t leaves = 0;
    rt::ExpectedCost expected;
    double sah_cost = 0;  // weighted by the given costs
};
// Measures the trees on the calling thread. `groups` are those of the build's input.
Quality measure(const Topology& topology, const rt_group* groups, float traversal_cost, float intersection_cost);

}  // namespace clarity::bvh
