// sphere_tree.hpp -- one tree of bounding spheres, as the thesis has it: a sphere is that of its box, centre and half diagonal,
// and its primitives are parted into even halves by count along the box's longest axis, until few enough are left.
#pragma once
#include <cstdint>

#include "rt_plugin.hpp"
// after rt_types.h, whose types it uses:
#include "spheres_types.h"

namespace spheres {

struct Box {
    float lo[3], hi[3];
    Box();
    void add(const Box& other);
    int longest_axis() const;
    float center(int axis) const { return 0.5f * lo[axis] + 0.5f * hi[axis]; }
};

// A primitive while the trees are built. Its box is finite and the right way round.
struct Item {
    Box box;
    rt_u32 ref;
};
Item make_item(const rt_prim& prim);

struct Rules {
    uint32_t max_leaf, max_depth;
};

// Nodes of a tree over `count` items: even halves make it a matter of numbers alone, so every node's place is known before it
// is made and all cores can write at once. Steps: twice the depth.
uint64_t tree_size(const Rules& rules, uint64_t count, uint32_t depth = 0);

// Sets centre and radius. Every corner of the box is within: the radius is rounded up.
void set_sphere(spheres_node& node, const Box& box);

struct Forest {
    const rt_host* host;
    Rules rules;
    Item* items;          // parted in place: their order becomes the leaf order
    spheres_node* nodes;  // the finished slot
};

// Builds the tree over items [first, first + count), count > 0, from nodes[at] on; the root is said to be of the given level.
void build_tree(const Forest& forest, uint32_t first, uint32_t count, uint32_t at, uint32_t level);

}  // namespace spheres
