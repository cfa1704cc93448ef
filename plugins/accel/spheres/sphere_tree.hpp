// sphere_tree.hpp -- builds a tree of bounding spheres, as in the thesis. The sphere of a node encloses its box: same centre,
// radius half the diagonal. A node splits its primitives into halves by count along the longest axis of its box, until few
// enough are left.
#pragma once
#include <cstdint>

#include "rt_plugin.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "spheres_types.h"

namespace spheres {

struct Box {
    float lo[3], hi[3];
    Box();
    void add(const Box& other);
    int longest_axis() const;
    float center(int axis) const { return 0.5f * lo[axis] + 0.5f * hi[axis]; }
};

// A primitive during the build. Its box is finite and its bounds are ordered.
struct Item {
    Box box;
    rt_u32 ref;
};
Item make_item(const rt_prim& prim);

// Radius of a leaf that every ray enters. It is finite, so that the ray test computes no NaN.
constexpr float kEverywhere = 1e30f;

struct Rules {
    uint32_t max_leaf, max_depth;
};

// Returns the number of nodes of a tree over `count` items. Because nodes split into equal halves, the size depends on the
// count only. So the index of every node is known before the node is made, and all cores can write at the same time. Takes a
// number of steps proportional to the depth.
uint64_t tree_size(const Rules& rules, uint64_t count, uint32_t depth = 0);

// Sets the centre and the radius of a node. The radius is rounded up, so that every corner of the box is inside.
void set_sphere(spheres_node& node, const Box& box);

struct Forest {
    const rt_host* host;
    Rules rules;
    Item* items;          // reordered in place; their final order is the leaf order
    spheres_node* nodes;  // the output slot
};

// Builds the tree over items [first, first + count), count > 0, and writes its nodes from nodes[at] on. `level` is the level of
// the root.
void build_tree(const Forest& forest, uint32_t first, uint32_t count, uint32_t at, uint32_t level);

}  // namespace spheres
