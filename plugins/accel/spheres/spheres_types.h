/* spheres_types.h -- trees of bounding spheres, in an order that needs no stack. Shared by builder and traversal. */
#ifndef SPHERES_TYPES_H
#define SPHERES_TYPES_H

/* A sphere around all primitives below, or the head of a group. 32 B.
 *
 * Nodes stand in depth-first order: after a sphere that the ray enters comes the next element (its first child, where it is no
 * leaf), after one that it misses, and after a leaf, comes the element `skip`. So a traversal only ever goes forwards.
 *
 * The root of a group is its head, which is no sphere: the group's trees follow it, one for each mesh, and its `skip` is where the
 * group ends. Nothing stands above the meshes' roots, which are tried one after the other, unless `top_level` is set. */
typedef struct spheres_node {
    rt_f32 center[3];
    rt_f32 radius;
    rt_u32 first, count; /* primitives, as positions in leaf order; count is 0 in inner nodes and heads */
    rt_u32 skip;
    rt_u32 level; /* below the root of its mesh's tree, or of the tree above the meshes; for drawing */
} spheres_node;
#endif
