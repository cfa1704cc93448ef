/* bvh8_node.h -- the slab test of a node's eight children, and reading a node.
 *
 * One ray, or an interval of rays, is tested against all children at once, each in its own lane of a vector of eight. */
#ifndef BVH8_NODE_H
#define BVH8_NODE_H

/* A row of a node by its distance from the node's begin in bytes. A traversal keeps these distances in registers: with an index
 * the compiler would multiply for each node. Far planes lie 96 bytes away from near ones. */
#define BVH8_ROW(node, bytes) (*(const global float8 *)((node) + (bytes)))
#define BVH8_CHILDREN(node) ((const global uint *)((node) + 192))

/* The bits of a mask of eight children, child 0 in bit 0: as rt_bits of lanes.h, but not for RT_LANES rays. */
#if !defined(RT_PORTABLE) && defined(__AVX__) && RT_HAS_BUILTIN(__builtin_ia32_movmskps256)
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

/* Where the near and far planes of a node's children lie, in bytes from the node's begin, for one octant of directions. */
typedef struct bvh8_rows {
    ulong near_x, near_y, near_z, far_x, far_y, far_z;
} bvh8_rows;

/* negative_x ..: whether the direction's component is negative. */
RT_INLINE bvh8_rows bvh8_rows_of(bool negative_x, bool negative_y, bool negative_z)
{
    bvh8_rows rows;
    rows.near_x = negative_x ? 96u : 0u;
    rows.near_y = negative_y ? 128u : 32u;
    rows.near_z = negative_z ? 160u : 64u;
    rows.far_x = 96u - rows.near_x;
    rows.far_y = 160u - rows.near_y;
    rows.far_z = 224u - rows.near_z;
    return rows;
}

/* What the slab test needs of a ray, or of an interval of rays: a near plane p is met at fma(near_slope, p, near_offset), a far
 * one at fma(far_slope, p, far_offset). */
typedef struct bvh8_slab_ray {
    float near_slope_x, near_slope_y, near_slope_z, near_offset_x, near_offset_y, near_offset_z;
    float far_slope_x, far_slope_y, far_slope_z, far_offset_x, far_offset_y, far_offset_z;
} bvh8_slab_ray;

/* The distances *in .. *out at which the ray is inside each child, between t_min and t. It misses a child if *in > *out. The
 * far side is widened here by its rounding error, RT_WIDE. A program of one lane has that done once for each ray instead
 * (bvh8_single_ray.cl). */
RT_INLINE void bvh8_intersect(const global char *node, const bvh8_rows *rows, const bvh8_slab_ray *r, float t_min, float t, float8 *in,
                              float8 *out)
{
    const float8 ax = fma((float8)(r->near_slope_x), BVH8_ROW(node, rows->near_x), (float8)(r->near_offset_x));
    const float8 ay = fma((float8)(r->near_slope_y), BVH8_ROW(node, rows->near_y), (float8)(r->near_offset_y));
    const float8 az = fma((float8)(r->near_slope_z), BVH8_ROW(node, rows->near_z), (float8)(r->near_offset_z));
    const float8 bx = fma((float8)(r->far_slope_x), BVH8_ROW(node, rows->far_x), (float8)(r->far_offset_x));
    const float8 by = fma((float8)(r->far_slope_y), BVH8_ROW(node, rows->far_y), (float8)(r->far_offset_y));
    const float8 bz = fma((float8)(r->far_slope_z), BVH8_ROW(node, rows->far_z), (float8)(r->far_offset_z));
    *in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(t_min)));
#if RT_LANES == 1
    *out = rt_min(rt_min(bx, by), rt_min(bz, (float8)(t)));
#else
    *out = rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, (float8)(t));
#endif
}

/* A stack entry: entry distance in the upper half, node reference in the lower. Distances are not negative, so entries are
 * ordered by them as integers. */
#define BVH8_ENTRY(t, ref) ((ulong)as_uint(t) << 32 | (ref))
#define BVH8_ENTRY_T(entry) as_float((uint)((entry) >> 32))

/* Prefetches what a traversal will read at a node or leaf, four lines of the cache. Packets trace trees that are larger than a
 * core's cache a sixth faster for it. */
RT_INLINE void bvh8_prefetch_at(ulong address)
{
#if RT_CPU && RT_HAS_BUILTIN(__builtin_prefetch) && !defined(__SPIR__) /* simulators compile for SPIR */
    __attribute__((opencl_unroll_hint(4)))
    for (uint i = 0; i < 256u; i += 64u) __builtin_prefetch((const void *)(address + i));
#endif
}
RT_INLINE void bvh8_prefetch(const global bvh8_node *nodes, const global rt_packed_prim *leaves, uint ref)
{
    bvh8_prefetch_at(ref & BVH8_LEAF ? (ulong)(leaves + BVH8_LEAF_FIRST(ref)) : (ulong)(nodes + ref));
}

#endif
