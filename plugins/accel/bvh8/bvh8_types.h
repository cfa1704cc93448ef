/* bvh8_types.h -- a tree with up to eight children a node. A node holds their boxes plane by plane, so that one ray is tested
 * against all of them at once. Shared by builder and traversal.
 *
 * Wald, Benthin, Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using Multi-branching BVHs";
 * Dammertz, Hanika, Keller 2008, "Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays". */
#ifndef BVH8_TYPES_H
#define BVH8_TYPES_H

#define BVH8_WIDTH 8

/* 224 B, a multiple of 32, so that a row is one aligned vector. plane[k] is a row: for k = 0..2 the children's lower bounds in
 * x, y, z, for k = 3..5 the upper ones. Bounds are exact and not padded: the traversal accounts for its own rounding.
 *
 * A child's slot tells where in the node it lies. Let s have the signs of the direction in bits 0, 1, 2, for x, y, z: then
 * visiting slot i ^ s for i = 0..7 mostly meets near children before far ones (Ylitie, Karras, Laine 2017, "Efficient
 * Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs"). */
typedef struct bvh8_node {
    rt_f32 plane[6][BVH8_WIDTH];
    rt_u32 child[BVH8_WIDTH];
} bvh8_node;

/* A child is a node reference: the index of a node, or, with bit 31 set, a leaf. Bits 28..30 of a leaf are the number of its
 * primitives (0..7), bits 0..27 the position of the first in leaf order.
 *
 * The root of a group is always a node. A slot without a child is a leaf of no primitives in a box of no extent at (FLT_MAX,
 * FLT_MAX, FLT_MAX). Hardly any ray enters that box, and one that does finds nothing to test. */
#define BVH8_LEAF 0x80000000u
#define BVH8_LEAF_MAX 7u
#define BVH8_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH8_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH8_MAKE_LEAF(first, count) (BVH8_LEAF | ((count) << 28) | (first))
#define BVH8_EMPTY BVH8_MAKE_LEAF(0u, 0u)

#if defined(__OPENCL_VERSION__) && defined(RT_LANES) /* kernels of builds have none */
#include "bvh8_node.h"
#if RT_LANES > 1
/* Whether a packet is traced as an incoherent one because its rays start far apart. That gains nothing in trees in which
 * packets stay together. */
#if BVH8_SINGLE
#define BVH8_INCOHERENT(ray, octants) ((octants) != 0u && (ray)->incoherent)
#else
#undef RT_SPLITS_INCOHERENT /* packets stay together in this tree, so tracers need not find out whether they are incoherent */
#define BVH8_INCOHERENT(ray, octants) 0
#endif
#include "bvh8_interval.h"
#include "bvh8_stream_stack.h"
#include "bvh8_mixed_rays.h"
#include "bvh8_ray_stacks.h"
#endif
#endif
#endif
