/* bvh8_ray_stacks.h -- the rays of a packet that go separate ways, each with a stack of its own (bvh8_interleaved.cl). */
#ifndef BVH8_RAY_STACKS_H
#define BVH8_RAY_STACKS_H

/* A stack holds the children that its ray deferred, the next one on top, and the ray's entry distances. The lowest entries are
 * sentinels that end every search: eight that a search of eight entries finds, and one that is taken untested. */
#define BVH8_SENTINELS 9u
#define BVH8_RAY_STACK (BVH8_SENTINELS + BVH8_STACK + 15u) /* eight more are written than count; no multiple of a page apart */

/* 60 KB at most. */
typedef struct bvh8_ray_stacks {
    rt_single_rays rays;
    rt_single_hits hits;
    int near_x[RT_LANES], near_y[RT_LANES], near_z[RT_LANES]; /* bvh8_rows of each ray, in half the bytes */
    int far_x[RT_LANES], far_y[RT_LANES], far_z[RT_LANES];
    int8 slots[RT_LANES]; /* a node's slots in the order in which they are pushed: the last is met first */
    uint top[RT_LANES];   /* in the arrays below */
    float entry[RT_LANES * BVH8_RAY_STACK];
    uint child[RT_LANES * BVH8_RAY_STACK];
} bvh8_ray_stacks;

RT_INLINE void bvh8_begin_ray_stacks(bvh8_ray_stacks *s, const rt_rays *ray, const rt_hits *hit)
{
    rt_spread_rays(ray, &s->rays);
    rt_spread_hits(hit, &s->hits);
    rt_store(rt_select(rt_negative(ray->ix), rt_vint(96), rt_vint(0)), s->near_x);
    rt_store(rt_select(rt_negative(ray->iy), rt_vint(128), rt_vint(32)), s->near_y);
    rt_store(rt_select(rt_negative(ray->iz), rt_vint(160), rt_vint(64)), s->near_z);
    rt_store(rt_select(rt_negative(ray->ix), rt_vint(0), rt_vint(96)), s->far_x);
    rt_store(rt_select(rt_negative(ray->iy), rt_vint(32), rt_vint(128)), s->far_y);
    rt_store(rt_select(rt_negative(ray->iz), rt_vint(64), rt_vint(160)), s->far_z);
    int order[RT_LANES];
    rt_store(~bvh8_octants(ray) & rt_vint(7), order);
    for (uint l = 0; l < RT_LANES; ++l) {
        vstore8((float8)(-INFINITY), 0, s->entry + l * BVH8_RAY_STACK + 1u);
        vstore8((uint8)(BVH8_EMPTY), 0, s->child + l * BVH8_RAY_STACK + 1u);
        s->top[l] = l * BVH8_RAY_STACK + BVH8_SENTINELS;
        s->slots[l] = (int8)(0, 1, 2, 3, 4, 5, 6, 7) ^ (int8)(order[l]);
    }
}

#if !defined(RT_PORTABLE) && defined(__AVX512VL__) && RT_HAS_BUILTIN(__builtin_ia32_permvarsf256) && \
    RT_HAS_BUILTIN(__builtin_ia32_permvarsi256) && RT_HAS_BUILTIN(__builtin_ia32_compresssf256_mask) && \
    RT_HAS_BUILTIN(__builtin_ia32_compresssi256_mask)
#define BVH8_COMPRESSES
#endif

/* Writes the children of a node that a ray enters, and its entry distances, in the order of `slots`. Returns their number.
 * Eight are written, whatever their number. */
RT_INLINE uint bvh8_push(float8 in, float8 out, const global char *node, const int8 *slots, float *entry, uint *child)
{
#ifdef BVH8_COMPRESSES
    const int8 slot = *slots;
    const float8 from = __builtin_ia32_permvarsf256(in, slot), to = __builtin_ia32_permvarsf256(out, slot);
    const int8 children = __builtin_ia32_permvarsi256(*(const global int8 *)(node + 192), slot);
    const uint bits = BVH8_BITS(from <= to);
    vstore8(__builtin_ia32_compresssf256_mask(from, from, (uchar)bits), 0, entry);
    vstore8(__builtin_ia32_compresssi256_mask(children, children, (uchar)bits), 0, (int *)child);
    return popcount(bits);
#else
    const global uint *children = BVH8_CHILDREN(node);
    float from[BVH8_WIDTH];
    vstore8(in, 0, from);
    const uint bits = BVH8_BITS(in <= out);
    uint count = 0;
    for (uint i = 0; i < BVH8_WIDTH; ++i) {
        const uint slot = ((const uint *)slots)[i];
        entry[count] = from[slot];
        child[count] = children[slot];
        count += bits >> slot & 1u;
    }
    return count;
#endif
}

/* The same for any-hit queries, for which neither distances nor order matter. */
RT_INLINE uint bvh8_push_any(float8 in, float8 out, const global char *node, uint *child)
{
    const uint bits = BVH8_BITS(in <= out);
#ifdef BVH8_COMPRESSES
    const int8 children = *(const global int8 *)(node + 192);
    vstore8(__builtin_ia32_compresssi256_mask(children, children, (uchar)bits), 0, (int *)child);
    return popcount(bits);
#else
    const global uint *children = BVH8_CHILDREN(node);
    uint count = 0;
    for (uint i = 0; i < BVH8_WIDTH; ++i) {
        child[count] = children[i];
        count += bits >> i & 1u;
    }
    return count;
#endif
}

#endif
