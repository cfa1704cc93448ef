/* bvh4_types.h -- a tree whose nodes hold the boxes of up to four children, one number of each in a row, so that a ray fetches
 * its near and far planes as whole rows (Wald, Benthin, Boulos 2008, "Getting Rid of Packets"). Shared by builder and traversal. */
#ifndef BVH4_TYPES_H
#define BVH4_TYPES_H

/* 128 B, a line of a GPU's cache; a row is one 16-byte load. plane[k] for k = 0..2 are the children's lower bounds in x, y, z,
 * for k = 3..5 the upper ones: exact, not padded, for the traversal accounts for its own rounding. Bits 0 and 1 of a child's
 * slot say on which side it lies in x and y, as far as slots were free. */
typedef struct bvh4_node {
    rt_f32 plane[6][4];
    rt_u32 child[4];
    rt_u32 pad[4];
} bvh4_node;

/* A child is the index of a node, or, with bit 31 set, a leaf: bits 28..30 count its primitives (1..7), bits 0..27 are the
 * position of the first in leaf order.
 *
 * The root of a group is always a node. A slot without child is BVH4_NOTHING in a box from +inf to -inf, which no ray enters. */
#define BVH4_LEAF 0x80000000u
#define BVH4_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH4_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH4_MAKE_LEAF(first, count) (BVH4_LEAF | ((count) << 28) | (first))
#define BVH4_NOTHING BVH4_MAKE_LEAF(0u, 0u)

#ifdef __OPENCL_VERSION__
#if RT_LANES == 1

#define RT_TRAVERSES_LONG_RAYS
#ifdef RT_PATIENCE
#define BVH4_LONG_STACK (BVH4_STACK + 512u)
typedef struct rt_long_scratch {
    ulong stack[BVH4_LONG_STACK];
    uint put[2];  /* entries put back in this turn and in the next */
    uint nearest; /* bits of the distance; any hit: 0 once there is one */
} rt_long_scratch;
#endif

#define BVH4_DONE 0xFFFFFFFFu /* in place of a child: the stack is empty */

/* Of floats, by the order of their bits: the same where either is not negative, and the compiler makes one instruction of two of
 * them (VIMNMX3 on Hopper): an eighth of all rays' time. Of two negative entries the lesser is taken and of two negative exits
 * the greater, so no box is missed that is met. */
#define BVH4_MAX(a, b) as_float4(max(as_int4(a), as_int4(b)))
#define BVH4_MIN(a, b) as_float4(min(as_int4(a), as_int4(b)))

/* What of a ray every node needs. The far side is widened here instead of in each node: that rounds twice more, each time by half
 * an ulp of origin / direction or of the distance, for which the slack of rt_prepare and RT_WIDE have room. */
typedef struct bvh4_ray {
    uint near_x, near_y, near_z, far_x, far_y, far_z; /* bytes from a node's begin to the rows of near and far planes */
    float wide_x, wide_y, wide_z, exit_x, exit_y, exit_z;
} bvh4_ray;

RT_INLINE bvh4_ray bvh4_prepare(const rt_rays *ray)
{
    bvh4_ray own;
    own.near_x = ray->ix < 0.0f ? 48u : 0u;
    own.near_y = ray->iy < 0.0f ? 64u : 16u;
    own.near_z = ray->iz < 0.0f ? 80u : 32u;
    own.far_x = 48u - own.near_x;
    own.far_y = 80u - own.near_y;
    own.far_z = 112u - own.near_z;
    own.wide_x = ray->ix * RT_WIDE;
    own.wide_y = ray->iy * RT_WIDE;
    own.wide_z = ray->iz * RT_WIDE;
    own.exit_x = ray->far_x * RT_WIDE;
    own.exit_y = ray->far_y * RT_WIDE;
    own.exit_z = ray->far_z * RT_WIDE;
    return own;
}

/* Where the children are entered, INFINITY: nowhere before `t`. Arguments: rows of near and of far planes. */
RT_INLINE float4 bvh4_enter(const rt_rays *ray, const bvh4_ray *own, float t, float4 near_x, float4 near_y, float4 near_z,
                            float4 far_x, float4 far_y, float4 far_z)
{
    const float4 ax = fma((float4)(ray->ix), near_x, (float4)(ray->near_x));
    const float4 ay = fma((float4)(ray->iy), near_y, (float4)(ray->near_y));
    const float4 az = fma((float4)(ray->iz), near_z, (float4)(ray->near_z));
    const float4 bx = fma((float4)(own->wide_x), far_x, (float4)(own->exit_x));
    const float4 by = fma((float4)(own->wide_y), far_y, (float4)(own->exit_y));
    const float4 bz = fma((float4)(own->wide_z), far_z, (float4)(own->exit_z));
    const float4 in = BVH4_MAX(BVH4_MAX(ax, ay), BVH4_MAX(az, (float4)(ray->t_min)));
    const float4 out = BVH4_MIN(BVH4_MIN(bx, by), BVH4_MIN(bz, (float4)(t)));
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

/* On the stack: entry distance in the upper half, child in the lower. Below all of them, in reach of any ray: */
#define BVH4_BOTTOM ((ulong)as_uint(-INFINITY) << 32 | BVH4_DONE)
#define BVH4_ENTRY(t, child) ((ulong)as_uint(t) << 32 | (child))

#endif
#endif
#endif
