// builder.hpp -- builds a kd-tree by the surface area heuristic with perfect splits: Wald, Havran 2006, "On building fast
// kd-Trees for Ray Tracing, and on doing that in O(N log N)".
#pragma once
#include <vector>

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

// A tree, the root first. Children stand behind their parents. The list has numbers of primitives within the group.
struct Tree {
    std::vector<kdtree_node> nodes;
    std::vector<rt_u32> list;
    rt_u32 depth = 0, leaves = 0;  // leaves: those with primitives
};

// Appends a tree, with its root in the place of an existing node.
void append(Tree& to, size_t place, const Tree& from);

// Builds the tree of a group. `box` receives the bounds of its primitives.
Tree build_tree(const rt_host* host, const Rules& rules, const rt_prim* prims, rt_u32 count, const rt_packed_prim* triangles,
                Box& box);

}  // namespace kdtree
