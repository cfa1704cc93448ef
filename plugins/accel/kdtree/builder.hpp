// builder.hpp -- builds a kd-tree by the surface area heuristic with perfect splits: Wald, Havran 2006, "On building fast
// kd-Trees for Ray Tracing, and on doing that in O(N log N)".
#pragma once
#include <vector>

#include "clarity_space/plane_tree.hpp"
#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "kdtree_types.h"

namespace kdtree {

struct Box {
    float lo[3], hi[3];
};

// A primitive within a node: the bounds of its part there.
struct Item {
    Box box;
    rt_u32 prim;  // number within the group
};

// The cost of a ray in a node is `traversal`, that of a primitive in a leaf `intersection`.
struct Rules {
    double traversal, intersection;
    double empty_bonus;  // share of its cost that a plane saves which cuts off empty space
    rt_u32 max_depth;
};

using Tree = clarity::space::PlaneTree<kdtree_node, 2>;
static_assert(Tree::kLeaf == KDTREE_LEAF, "kernels know leaves by it");

// Builds the tree of a group. `box` receives the bounds of its primitives.
Tree build_tree(const rt_host* host, const Rules& rules, const rt_prim* prims, rt_u32 count, const rt_packed_prim* triangles,
                Box& box);

}  // namespace kdtree
