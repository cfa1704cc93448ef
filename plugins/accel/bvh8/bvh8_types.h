/* bvh8_types.h -- a tree whose nodes hold the boxes of up to eight children, one number of each in a row, so that one ray is
 * tested against all of them at once (Wald, Benthin, Boulos 2008, "Getting Rid of Packets"; Dammertz, Hanika, Keller 2008,
 * "Shallow Bounding Volume Hierarchies for Fast SIMD Ray Tracing of Incoherent Rays"). Shared by builder and traversal. */
#ifndef BVH8_TYPES_H
#define BVH8_TYPES_H

#ifndef BVH8_WIDTH
#define BVH8_WIDTH 8
#endif

/* 224 B, a multiple of 32: a row is one aligned vector. plane[k] for k = 0..2 are the children's lower bounds in x, y, z, for
 * k = 3..5 the upper ones: exact, not padded, for the traversal accounts for its own rounding. The slot of a child says where
 * in the node it lies: visiting slot i ^ s for i = 0..7, bits 0, 1, 2 of s being the signs of the direction in x, y, z, meets
 * near children before far ones, more or less (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
 * Compressed Wide BVHs"). */
typedef struct bvh8_node {
    rt_f32 plane[6][BVH8_WIDTH];
    rt_u32 child[BVH8_WIDTH];
#if BVH8_WIDTH == 4 /* bvh4 */
    rt_u32 pad[4];
#endif
} bvh8_node;

/* A child is the index of a node, or, with bit 31 set, a leaf: bits 28..30 count its primitives (0..7), bits 0..27 are the
 * position of the first in leaf order.
 *
 * The root of a group is always a node. A slot without child is a leaf of no primitives in a box of no extent at (FLT_MAX,
 * FLT_MAX, FLT_MAX): out of reach for nearly every ray, and harmless for the others. */
#define BVH8_LEAF 0x80000000u
#define BVH8_LEAF_MAX 7u
#define BVH8_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH8_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH8_MAKE_LEAF(first, count) (BVH8_LEAF | ((count) << 28) | (first))
#define BVH8_NOTHING BVH8_MAKE_LEAF(0u, 0u)

#ifdef __OPENCL_VERSION__
/* Mask to bits, lane 0 in bit 0: as rt_bits of lanes.h, for eight children instead of RT_LANES rays. */
#if !defined(RT_PORTABLE) && defined(__x86_64__) && defined(__AVX__)
#define BVH8_BITS(m) ((uint)__builtin_ia32_movmskps256(as_float8(m)))
#else
RT_INLINE uint bvh8_bits(int8 m)
{
    const int8 weighted = m & (int8)(1, 2, 4, 8, 16, 32, 64, 128);
    const int4 four = weighted.lo | weighted.hi;
    const int2 two = four.lo | four.hi;
    return (uint)(two.x | two.y);
}
#define BVH8_BITS(m) bvh8_bits(m)
#endif
#define BVH8_LOWEST(bits) popcount(~(bits) & ((bits)-1u)) /* index of the lowest bit that is set */
/* Rows of a node by their distance from its begin in bytes: kept in registers, where an index would be multiplied anew. */
#define BVH8_ROW(node, bytes) (*(const global float8 *)((node) + (bytes)))
/* Entry distance in the upper half, child in the lower: distances are not negative, so keys sort as they are. */
#define BVH8_KEY(entry, child, i) ((ulong)as_uint((entry)[i]) << 32 | (child)[i])
#endif
#endif
