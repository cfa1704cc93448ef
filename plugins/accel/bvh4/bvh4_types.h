/* bvh4_types.h -- a tree whose nodes hold the boxes of up to four children, one number of each in a row, so that a ray fetches
 * its near and far planes as whole rows (Wald, Benthin, Boulos 2008, "Getting Rid of Packets"). Shared by builder and traversal. */
#ifndef BVH4_TYPES_H
#define BVH4_TYPES_H

/* 128 B, a line of a GPU's cache; a row is one 16-byte load. plane[k] for k = 0..2 are the children's lower bounds in x, y, z,
 * for k = 3..5 the upper ones: exact, not padded, for the traversal accounts for its own rounding. Bits 0 and 1 of a child's
 * slot say on which side it lies in x and y, as far as slots were free.
 *
 * So much for the builder. In memory row k of node i stands where row k ^ (i & 7) would: the lanes of a warp read the same row of
 * different nodes, all of which would come from the same eighth of the cache's banks. */
typedef struct bvh4_node {
    rt_f32 plane[6][4];
    rt_u32 child[4];
    rt_u32 pad[4];
} bvh4_node;

/* A child is the place of a node, or, with bit 31 set, a leaf: bits 28..30 count its primitives (1..7), bits 0..27 are the
 * position of the first in leaf order.
 *
 * A place is where row 0 of a node stands, in rows from where the first node begins; row k stands at place ^ k. The root of a group
 * is always a node, reported by its index. A slot without child is BVH4_EMPTY in a box from +inf to -inf, which no ray enters. */
#define BVH4_LEAF 0x80000000u
#define BVH4_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH4_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH4_MAKE_LEAF(first, count) (BVH4_LEAF | ((count) << 28) | (first))
#define BVH4_EMPTY BVH4_MAKE_LEAF(0u, 0u)
#define BVH4_NODE_REF(index) ((index) << 3 | ((index)&7u))
#define BVH4_INDEX(place) ((place) >> 3)

#ifdef __OPENCL_VERSION__
#if RT_LANES == 1

#ifdef RT_STEP_BUDGET
#define BVH4_LONG_STACK (BVH4_STACK + 512u)
typedef struct rt_requeue_scratch {
    ulong stack[BVH4_LONG_STACK];
    uint put[2];  /* entries put back in this turn and in the next */
    uint nearest; /* bits of the distance; any hit: 0 once there is one */
} rt_requeue_scratch;
#endif

#define BVH4_DONE 0xFFFFFFFFu /* in place of a child: the stack is empty */

/* Of floats, by the order of their bits: the same where either is not negative, and the compiler makes one instruction of two of
 * them (VIMNMX3 on Hopper): an eighth of all rays' time. Of two negative entries the lesser is taken and of two negative exits
 * the greater, so no box is missed that is met. */
#define BVH4_MAX(a, b) as_float4(max(as_int4(a), as_int4(b)))
#define BVH4_MIN(a, b) as_float4(min(as_int4(a), as_int4(b)))

/* Where row 0 of a node stands, and the row that stands `bytes` across from it: nodes are lines of a buffer that begins with one.
 * The far plane of an axis stands across its near one. */
#define BVH4_NODE(ctx, place) ((ulong)(ctx)->bvh4_nodes + ((ulong)(place) << 4))
#define BVH4_ROW(node, bytes) (*(const global float4 *)((node) ^ (ulong)(bytes)))
#define BVH4_NEAR_X(negative) ((negative) ? 48u : 0u)
#define BVH4_NEAR_Y(negative) ((negative) ? 64u : 16u)
#define BVH4_NEAR_Z(negative) ((negative) ? 80u : 32u)
#define BVH4_RAY_SPACE_X 48u
#define BVH4_RAY_SPACE_Y 80u
#define BVH4_RAY_SPACE_Z 112u
#define BVH4_CHILDREN 96u

/* What of a ray every node needs. The far side is widened here instead of in each node: that rounds twice more, each time by half
 * an ulp of origin / direction or of the distance, for which the slack of rt_prepare and RT_WIDE have room. */
typedef struct bvh4_ray {
    uint near_x, near_y, near_z; /* rows of the near planes, for BVH4_ROW */
    float wide_x, wide_y, wide_z, exit_x, exit_y, exit_z;
} bvh4_ray;

RT_INLINE bvh4_ray bvh4_prepare(const rt_rays *ray)
{
    bvh4_ray own;
    own.near_x = BVH4_NEAR_X(ray->ix < 0.0f);
    own.near_y = BVH4_NEAR_Y(ray->iy < 0.0f);
    own.near_z = BVH4_NEAR_Z(ray->iz < 0.0f);
    own.wide_x = ray->ix * RT_WIDE;
    own.wide_y = ray->iy * RT_WIDE;
    own.wide_z = ray->iz * RT_WIDE;
    own.exit_x = ray->far_x * RT_WIDE;
    own.exit_y = ray->far_y * RT_WIDE;
    own.exit_z = ray->far_z * RT_WIDE;
    return own;
}

/* Where the ray is in all slabs of the children, before `t`: from *in to *out, in none if that is less. Arguments: rows of near
 * and of far planes. */
RT_INLINE void bvh4_slabs(const rt_rays *ray, const bvh4_ray *own, float t, float4 near_x, float4 near_y, float4 near_z,
                          float4 far_x, float4 far_y, float4 far_z, float4 *in, float4 *out)
{
    const float4 ax = fma((float4)(ray->ix), near_x, (float4)(ray->near_x));
    const float4 ay = fma((float4)(ray->iy), near_y, (float4)(ray->near_y));
    const float4 az = fma((float4)(ray->iz), near_z, (float4)(ray->near_z));
    const float4 bx = fma((float4)(own->wide_x), far_x, (float4)(own->exit_x));
    const float4 by = fma((float4)(own->wide_y), far_y, (float4)(own->exit_y));
    const float4 bz = fma((float4)(own->wide_z), far_z, (float4)(own->exit_z));
    *in = BVH4_MAX(BVH4_MAX(ax, ay), BVH4_MAX(az, (float4)(ray->t_min)));
    *out = BVH4_MIN(BVH4_MIN(bx, by), BVH4_MIN(bz, (float4)(t)));
}

/* Where the children are entered, INFINITY: nowhere. */
RT_INLINE float4 bvh4_enter(const rt_rays *ray, const bvh4_ray *own, float t, float4 near_x, float4 near_y, float4 near_z,
                            float4 far_x, float4 far_y, float4 far_z)
{
    float4 in, out;
    bvh4_slabs(ray, own, t, near_x, near_y, near_z, far_x, far_y, far_z, &in, &out);
    return in <= out ? in : (float4)(INFINITY);
}

/* The same number, but the compiler does not know: or it would join what is fetched under a condition with what is computed under
 * the same one, and the lanes of a warp that take the other way would wait for memory a second time. */
#ifdef __NV_CL_C_VERSION
RT_INLINE uint bvh4_hidden(uint x)
{
    uint same;
    __asm volatile("mov.b32 %0, %1;" : "=r"(same) : "r"(x));
    return same;
}
#else
#define bvh4_hidden(x) (x)
#endif

/* Puts two children in the order of their distances. */
RT_INLINE void bvh4_order(float *t0, uint *child0, float *t1, uint *child1)
{
    const bool swap = *t1 < *t0;
    const float t = swap ? *t1 : *t0;
    const uint child = swap ? *child1 : *child0;
    *t1 = swap ? *t0 : *t1;
    *child1 = swap ? *child0 : *child1;
    *t0 = t;
    *child0 = child;
}

/* On the stack: entry distance in the upper half, child in the lower. Lowest of all stands what ends the traversal, in reach of any
 * ray. */
#define BVH4_ENTRY(t, child) ((ulong)as_uint(t) << 32 | (child))
#define BVH4_LOWEST BVH4_ENTRY(-INFINITY, BVH4_DONE)

typedef ulong rt_step_entry;
typedef bvh4_ray rt_step_ray;
#define RT_STEP_STACK_SIZE (BVH4_STACK + 1u)
#define RT_STEP_DONE BVH4_DONE
#define RT_STEP_IS_LEAF(at) ((at) >= BVH4_LEAF)
RT_INLINE uint rt_begin_steps(uint root, const rt_rays *ray, rt_step_ray *turns, rt_step_entry *stack, uint *top)
{
    *turns = bvh4_prepare(ray);
    stack[0] = BVH4_LOWEST;
    *top = 1u;
    return BVH4_NODE_REF(root);
}

#endif
#endif
#endif
