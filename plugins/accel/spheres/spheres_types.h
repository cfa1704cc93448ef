/* spheres_types.h -- trees of bounding spheres, in an order that needs no stack. Shared by builder and traversal. */
#ifndef SPHERES_TYPES_H
#define SPHERES_TYPES_H

/* A sphere around all primitives below, or the head of a group. 32 B.
 *
 * Nodes stand in depth-first order. If the ray enters a sphere, the traversal goes on to the next element, which is the first
 * child of an inner node. If the ray misses it, and after a leaf, it goes on to the element `skip`. So it only goes forwards.
 *
 * The root of a group is its head, which is no sphere. The group's trees follow it, one for each mesh, and its `skip` is the
 * end of the group. The roots of the meshes have no node above them and are visited one after the other, unless `top_level` is
 * set. */
typedef struct spheres_node {
    rt_f32 center[3];
    rt_f32 radius;
    rt_u32 first, count; /* primitives, as positions in leaf order; count is 0 in inner nodes and heads */
    rt_u32 skip;
    rt_u32 level; /* below the root of its mesh's tree, or of the tree above the meshes; for drawing */
} spheres_node;
#endif
