/* bvh2_types.h -- a binary BVH whose nodes hold the boxes of both children, so that one fetch decides both (Aila and Laine 2009,
 * "Understanding the Efficiency of Ray Traversal on GPUs"). Shared by builder and traversal. */
#ifndef BVH2_TYPES_H
#define BVH2_TYPES_H

/* 64 B, one cache line. A box is lo.xyz, hi.xyz: the exact float bounds of the primitives below, not padded: the traversal
 * accounts for its own rounding. Child 0, if it is a node, is the next element (depth-first order); it has the larger surface where
 * the builder went by surfaces. */
typedef struct bvh2_node {
    rt_f32 box0[6];
    rt_u32 child0;
    rt_u32 pad0;
    rt_f32 box1[6];
    rt_u32 child1;
    rt_u32 pad1;
} bvh2_node;

/* A child is the index of a node, or, with bit 31 set, a leaf: bits 28..30 count its primitives (0..7), bits 0..27 are the
 * position of the first in leaf order. 28 bits are what an rt_packed_prim.ref can name, so no scene is too large for a child.
 *
 * The root of a group is always a node. Where a group has fewer than two leaves, the child that is left over is a leaf of no
 * primitives in a box of no extent at (FLT_MAX, FLT_MAX, FLT_MAX): out of reach for slab tests that order the two distances of a
 * slab (min/max) as well as for those that pick them by the sign of the direction; an inverted box would stop the latter only. */
#define BVH2_LEAF 0x80000000u
#define BVH2_LEAF_MAX 7u
#define BVH2_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH2_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH2_MAKE_LEAF(first, count) (BVH2_LEAF | ((count) << 28) | (first))
#endif
