// sphere_tree.hpp -- builds a tree of bounding volumes. A node splits its primitives into halves by count along the longest
// axis of their box, until few enough are left, as in the thesis; its volume is of any kind.
#pragma once
#include <cstdint>

#include "volumes.hpp"

namespace spheres {

// A primitive during the build. Its box is finite and its bounds are ordered.
struct Item {
    Box box;
    rt_u32 ref;
};
Item make_item(const rt_prim& prim);

struct Rules {
    uint32_t max_leaf, max_depth;
};

// Returns the number of nodes of a tree over `count` items. Because nodes split into equal halves, the size depends on the
// count only. So the index of every node is known before the node is made, and all cores can write at the same time. Takes a
// number of steps proportional to the depth.
uint64_t tree_size(const Rules& rules, uint64_t count, uint32_t depth = 0);

struct Forest {
    const rt_host* host;
    Rules rules;
    Item* items;  // reordered in place; their final order is the leaf order
    const rt_packed_prim* triangles;
    spheres_node* nodes;  // the output slot
    const Volumes& volumes;
};

// Builds the tree over items [first, first + count), count > 0, and writes its nodes from nodes[at] on.
void build_tree(const Forest& forest, uint32_t first, uint32_t count, uint32_t at);

}  // namespace spheres
