/* bvh2_types.h -- a binary BVH with the boxes of both children in each node, so that one fetch decides on both. Shared by
 * builder and traversal.
 *
 * Aila, Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs". */
#ifndef BVH2_TYPES_H
#define BVH2_TYPES_H

/* 64 B, one cache line. A box is lo.xyz, hi.xyz: the exact bounds of the primitives below, not padded, since the traversal
 * accounts for its own rounding. If child 0 is a node, it is the next element (depth-first order). It has the larger surface
 * where the builder ordered children by surface. */
typedef struct bvh2_node {
    rt_f32 box0[6];
    rt_u32 child0;
    rt_u32 pad0;
    rt_f32 box1[6];
    rt_u32 child1;
    rt_u32 pad1;
} bvh2_node;

/* A child is a node reference: the index of a node, or, with bit 31 set, a leaf. Bits 28..30 of a leaf are the number of its
 * primitives (0..7), bits 0..27 the position of the first in leaf order. An rt_packed_prim.ref has 28 bits too, so no scene is
 * too large.
 *
 * The root of a group is always a node. If a group has fewer than two leaves, the unused child is a leaf of no primitives in a
 * box of no extent at (FLT_MAX, FLT_MAX, FLT_MAX). Slab tests miss it whether they order the two distances of a slab or select
 * them by the sign of the direction. Only tests of the second kind would miss an inverted box. */
#define BVH2_LEAF 0x80000000u
#define BVH2_LEAF_MAX 7u
#define BVH2_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH2_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH2_MAKE_LEAF(first, count) (BVH2_LEAF | ((count) << 28) | (first))
#endif
