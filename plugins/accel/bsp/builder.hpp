// builder.hpp -- builds a BSP tree with planes in few directions by the surface area heuristic: Kammaje, Mora 2007, "A Study of
// Restricted BSP Trees for Ray Tracing"; the surfaces of cells: Budge, Coming, Norpchen, Joy 2008, "Accelerated Building and
// Ray Tracing of Restricted BSP Trees".
#pragma once
#include "cell.hpp"
#include "clarity_space/plane_tree.hpp"

namespace bsp {

// The cost of a ray at a plane of an axis is `traversal`, at another one `oblique`, that of a primitive in a leaf
// `intersection`.
struct Rules {
    double traversal, oblique, intersection;
    double empty_bonus;    // share of its cost that a plane saves which cuts off empty space
    rt_u32 directions;     // the first of BSP_DIRECTIONS
    rt_u32 oblique_below;  // nodes of more primitives are parted by axes alone
    rt_u32 max_depth;
};

using Tree = clarity::space::PlaneTree<bsp_node, 4>;
static_assert(Tree::kLeaf == BSP_LEAF && BSP_DIRECTIONS < BSP_LEAF, "kernels know leaves by it");

// Builds the tree of a group. `box` receives the bounds of its primitives.
Tree build_tree(const rt_host* host, const Rules& rules, const rt_prim* prims, rt_u32 count, const rt_packed_prim* triangles,
                Box& box);

}  // namespace bsp
