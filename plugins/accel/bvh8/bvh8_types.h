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
#define BVH8_EMPTY BVH8_MAKE_LEAF(0u, 0u)

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
/* Rows of a node by their distance from its begin in bytes: kept in registers, where an index would be multiplied anew. */
#define BVH8_ROW(node, bytes) (*(const global float8 *)((node) + (bytes)))
/* One number of one child, `box` being its slot's place in the first row. */
#define BVH8_PLANE(box, bytes) rt_vfloat(*(const global float *)((box) + (bytes)))
/* Bounds that have to be rounded outwards by the slack of rt_prepare(). */
#define BVH8_DOWN(v) ((v) - fabs(v) * (8.0f * RT_EPS))
#define BVH8_UP(v) ((v) + fabs(v) * (8.0f * RT_EPS))
/* Whether bounds of origins and of 1 / direction are so wide that rays are tested themselves before they go on. */
#define BVH8_WIDE(o_lo, o_hi, i_lo, i_hi) ((o_lo) != (o_hi) || (i_hi) - (i_lo) > 0.25f * fabs(i_lo))
#ifdef RT_COUNT_STEPS
#define BVH8_COUNT_VISITS(hits, inside)                                                                                          \
    for (uint count_in = inside; count_in != 0u; count_in &= count_in - 1u) RT_COUNT_STEP((hits) + rt_lowest(count_in));
#else
#define BVH8_COUNT_VISITS(hits, inside)
#endif
/* Entry distance in the upper half, child in the lower: distances are not negative, so keys sort as they are. */
#define BVH8_KEY(entry, child, i) ((ulong)as_uint((entry)[i]) << 32 | (child)[i])
/* Asks for what will be read at a node or leaf, four lines of the cache, ahead of its turn: packets trace trees larger than a
 * core's cache a sixth faster for it. */
RT_INLINE void bvh8_prefetch_at(ulong lines)
{
#if RT_CPU && defined(__clang__) && (defined(__x86_64__) || defined(__aarch64__)) /* not in a simulator */
    __attribute__((opencl_unroll_hint(4)))
    for (uint i = 0; i < 256u; i += 64u) __builtin_prefetch((const void *)(lines + i));
#endif
}
RT_INLINE void bvh8_prefetch(const global bvh8_node *nodes, const global rt_packed_prim *leaves, uint at)
{
    bvh8_prefetch_at(at & BVH8_LEAF ? (ulong)(leaves + BVH8_LEAF_FIRST(at)) : (ulong)(nodes + at));
}
#if RT_LANES > 1
/* Whether a packet whose rays start far apart is parted. Where rays that part go together it gains nothing. */
#if BVH8_SINGLE
#define BVH8_INCOHERENT(ray, rest) ((rest) != 0u && (ray)->incoherent)
#else
#undef RT_SPLITS_INCOHERENT /* packets stay together in this tree, so nobody needs to find out */
#define BVH8_INCOHERENT(ray, rest) 0
#endif
/* Octants of directions that a packet may be split into: where it has more, its rays have too little in common. */
#define BVH8_SPLIT 2
/* Bits 0, 1, 2: the direction's component is negative. */
RT_INLINE vint bvh8_octants(const rt_rays *ray)
{
    return (rt_negative(ray->ix) & rt_vint(1)) | (rt_negative(ray->iy) & rt_vint(2)) | (rt_negative(ray->iz) & rt_vint(4));
}
/* Octants that active lanes have, as bits. */
RT_INLINE uint bvh8_which_octants(const rt_rays *ray, vint octants, vfloat t)
{
    const vmask alive = RT_MASK(t >= rt_vfloat(0.0f));
    if (!rt_any(alive)) return 0u;
    if (ray->coherent) return 1u << ((ray->lo_x != 0u ? 1u : 0u) | (ray->lo_y != 1u ? 2u : 0u) | (ray->lo_z != 2u ? 4u : 0u));
    uint which = 0;
    for (int i = 0; i < 8; ++i) which |= (rt_any(alive & RT_MASK(octants == rt_vint(i))) ? 1u : 0u) << i;
    return which;
}
/* Row of near planes of an axis, in bytes from the node's begin. */
#define BVH8_NEAR(octant, axis) ((octant) >> (axis) & 1u ? 96ul + 32ul * (axis) : 32ul * (axis))
/* What the packets of a stream have put off: node * 8 + slot, from which a child and its box are found again; the packets that
 * enter it; and where they do. Nearest hits: two lists of leaves, each of one node, then a stack of nodes. Any hits: a stack of
 * both. Below BVH8_STACK entries BVH8_AHEAD ways are gone at once, each of which may put off eight more, then one way only; and
 * eight are written before room is looked for. BVH8_STACK is a multiple of 16, so that the arrays are no multiple of a page,
 * which is slow. */
#define BVH8_LISTS (2u * BVH8_WIDTH)
#define BVH8_AHEAD 4u
#define BVH8_STREAM_STACK (2u * BVH8_STACK + BVH8_AHEAD * BVH8_WIDTH)
typedef struct bvh8_stream_stack {
    vfloat entry[BVH8_STREAM_STACK + BVH8_WIDTH];
    uint place[BVH8_STREAM_STACK + BVH8_WIDTH], packets[BVH8_STREAM_STACK + BVH8_WIDTH];
} bvh8_stream_stack;
/* Of the packets that entry `i` was put off with, those that have hit nothing nearer since. */
#define BVH8_STILL(i) (waiting.packets[i] & rt_bits(RT_MASK(waiting.entry[i] <= t_far)))

/* Children `some` of the node `at`, one or more, are put off from entry `top` on, the nearest to packet `guide` last, so that it
 * is the first to be taken, and are asked for. Returns where they end. */
RT_INLINE uint bvh8_push_deferred(bvh8_stream_stack *waiting, uint top, const global bvh8_node *nodes, const global rt_packed_prim *leaves, uint at,
                           uint some, const vfloat *entry, const uint *enters, uint guide)
{
    const global uint *child = nodes[at].child;
    const float *distance = (const float *)entry + guide;
#define BVH8_NEXT(key)                                                                                                           \
    const uint slot = rt_lowest(some);                                                                                         \
    some &= some - 1u;                                                                                                           \
    bvh8_prefetch(nodes, leaves, child[slot]);                                                                                   \
    const ulong key = (ulong)as_uint(distance[slot * RT_LANES]) << 32 | (at * BVH8_WIDTH + slot);
#define BVH8_WAIT(key)                                                                                                           \
    {                                                                                                                            \
        const uint which = (uint)(key) % BVH8_WIDTH;                                                                             \
        waiting->place[top] = (uint)(key);                                                                                       \
        waiting->packets[top] = enters[which];                                                                                   \
        waiting->entry[top] = entry[which];                                                                                      \
        ++top;                                                                                                                   \
    }
    BVH8_NEXT(first)
    ulong nearest = first;
    while (some != 0u) {
        BVH8_NEXT(next)
        const ulong farther = max(next, nearest);
        nearest = min(next, nearest);
        BVH8_WAIT(farther)
    }
    BVH8_WAIT(nearest)
#undef BVH8_WAIT
#undef BVH8_NEXT
    return top;
}

/* Rays of a packet that go their own ways, and what each has put off: children in the order in which they were met, the next one
 * on top, and where the ray enters them. Below each stack lie entries that end every search in it, for eight at a time and one
 * that is taken untested. 60 KB at most. */
#define BVH8_BELOW 9u
#define BVH8_ROOM (BVH8_BELOW + BVH8_STACK + 15u) /* eight more are written than count; no multiple of a page's size apart */
typedef struct bvh8_single_ray {
    rt_single_rays rays;
    rt_single_hits hits;
    int near_x[RT_LANES], near_y[RT_LANES], near_z[RT_LANES]; /* rows of a node in bytes, as the ray meets them */
    int far_x[RT_LANES], far_y[RT_LANES], far_z[RT_LANES];
    int8 slots[RT_LANES];                                     /* of a node's children, as the ray meets them: the first last */
    uint top[RT_LANES];                                       /* in the arrays below */
    float entry[RT_LANES * BVH8_ROOM];
    uint child[RT_LANES * BVH8_ROOM];
} bvh8_single_ray;

RT_INLINE void bvh8_single_ray_begin(bvh8_single_ray *s, const rt_rays *ray, const rt_hits *hit)
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
        vstore8((float8)(-INFINITY), 0, s->entry + l * BVH8_ROOM + 1u);
        vstore8((uint8)(BVH8_EMPTY), 0, s->child + l * BVH8_ROOM + 1u);
        s->top[l] = l * BVH8_ROOM + BVH8_BELOW;
        s->slots[l] = (int8)(0, 1, 2, 3, 4, 5, 6, 7) ^ (int8)(order[l]);
    }
}
#endif

/* The children of a node that a ray enters and where, in the order of the slots; returns how many. Eight are written. */
RT_INLINE uint bvh8_push(float8 in, float8 out, const global char *node, const int8 *slots, float *entry, uint *child)
{
#if !defined(RT_PORTABLE) && defined(__x86_64__) && defined(__AVX512VL__)
    const int8 slot = *slots;
    const float8 from = __builtin_ia32_permvarsf256(in, slot), to = __builtin_ia32_permvarsf256(out, slot);
    const int8 children = __builtin_ia32_permvarsi256(*(const global int8 *)(node + 192), slot);
    const uint bits = BVH8_BITS(from <= to);
    vstore8(__builtin_ia32_compresssf256_mask(from, from, (uchar)bits), 0, entry);
    vstore8(__builtin_ia32_compresssi256_mask(children, children, (uchar)bits), 0, (int *)child);
    return popcount(bits);
#else
    const global uint *children = (const global uint *)(node + 192);
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

/* The same where any hit will do: neither where nor in which order matters. */
RT_INLINE uint bvh8_push_any(float8 in, float8 out, const global char *node, uint *child)
{
    const uint bits = BVH8_BITS(in <= out);
#if !defined(RT_PORTABLE) && defined(__x86_64__) && defined(__AVX512VL__)
    const int8 children = *(const global int8 *)(node + 192);
    vstore8(__builtin_ia32_compresssi256_mask(children, children, (uchar)bits), 0, (int *)child);
    return popcount(bits);
#else
    const global uint *children = (const global uint *)(node + 192);
    uint count = 0;
    for (uint i = 0; i < BVH8_WIDTH; ++i) {
        child[count] = children[i];
        count += bits >> i & 1u;
    }
    return count;
#endif
}
#endif
#endif
