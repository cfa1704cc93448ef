/* spheres_types.h -- trees of bounding volumes, in an order that needs no stack. Shared by builder and traversal. */
#ifndef SPHERES_TYPES_H
#define SPHERES_TYPES_H

/* What the builder defines SPHERES_VOLUME as: the choices of `volume`. */
#define SPHERES_SPHERE 0u   /* center.xyz, radius */
#define SPHERES_BOX 1u      /* lo.xyz, hi.xyz */
#define SPHERES_ORIENTED 2u /* center.xyz, and half the extents along its axes */

/* A volume around all primitives below, or the head of a group. 32 B.
 *
 * Nodes stand in depth-first order. If the ray enters a volume, the traversal goes on to the next element, which is the first
 * child of an inner node. If the ray misses it, and after a leaf, it goes on to the element behind all nodes below. So it only goes
 * forwards.
 *
 * The root of a group is its head, which no ray is tested against. The group's trees follow it, one for each mesh, and its `link` is
 * the end of the group. The roots of the meshes have no node above them and are visited one after the other, unless `top_level` is
 * set. */
typedef struct spheres_node {
    rt_f32 volume[6];
    rt_u32 link;  /* of a leaf its first primitive, as a position in leaf order; of others the element behind all nodes below */
    rt_u32 count; /* primitives; 0 in inner nodes and heads */
} spheres_node;

/* The axes of an oriented box, of unit length but for rounding. 36 B. Other volumes have none. */
typedef struct spheres_axes {
    rt_f32 axis[9];
} spheres_axes;
#endif
