/* bvh4_types.h -- a tree with up to four children a node. A node holds their boxes plane by plane, so that a ray fetches its
 * near and far planes as whole rows. Shared by builder and traversal.
 *
 * Wald, Benthin, Boulos 2008, "Getting Rid of Packets: Efficient SIMD Single-Ray Traversal using Multi-branching BVHs". */
#ifndef BVH4_TYPES_H
#define BVH4_TYPES_H

/* 128 B, a line of a GPU's cache. A row is one 16-byte load. plane[k] is a row: for k = 0..2 the children's lower bounds in x,
 * y, z, for k = 3..5 the upper ones. Bounds are exact and not padded: the traversal accounts for its slab rounding. Bits 0 and
 * 1 of a child's slot tell on which side of the node it lies in x and y, as far as slots were free.
 *
 * The builder sees nodes like this. In memory row k of node i stands at row k ^ (i & 7): the rays of a warp read the same row
 * of different nodes, which would otherwise lie in the same eighth of the cache's banks. */
typedef struct bvh4_node {
    rt_f32 plane[6][4];
    rt_u32 child[4];
    rt_u32 pad[4];
} bvh4_node;

/* A child is a node reference: the position of a node, or, with bit 31 set, a leaf. Bits 28..30 of a leaf are the number of its
 * primitives (1..7), bits 0..27 the position of the first in leaf order.
 *
 * The position of a node is that of its row 0, in rows from the begin of the first node. Its row k stands at position ^ k. The
 * root of a group is always a node; the builder reports its index. A slot without a child is BVH4_EMPTY, with a box from +inf
 * to -inf that no ray enters. */
#define BVH4_LEAF 0x80000000u
#define BVH4_LEAF_MAX 7u
#define BVH4_LEAF_COUNT(child) (((child) >> 28) & 7u)
#define BVH4_LEAF_FIRST(child) ((child)&0x0FFFFFFFu)
#define BVH4_MAKE_LEAF(first, count) (BVH4_LEAF | ((count) << 28) | (first))
#define BVH4_EMPTY BVH4_MAKE_LEAF(0u, 0u)
#define BVH4_NODE_REF(index) ((index) << 3 | ((index)&7u))
#define BVH4_INDEX(ref) ((ref) >> 3)

#ifdef __OPENCL_VERSION__
#if RT_LANES == 1

#ifdef RT_STEP_BUDGET
#define BVH4_LONG_STACK (BVH4_STACK + 512u)
typedef struct rt_requeue_scratch {
    ulong stack[BVH4_LONG_STACK];
    uint pushed[2]; /* entries pushed in this round and in the next */
    uint nearest;   /* bits of the nearest hit's distance; any hit: 0 once there is one */
} rt_requeue_scratch;
#endif

#define BVH4_DONE 0xFFFFFFFFu /* instead of a node reference: the stack is empty */

/* A ray goes into instances in the same loop, so that the rays of a warp need not all wait while some are inside. Then the stack holds the
 * mesh's entries above the world's. BVH4_LEAVE between them ends the mesh; what is left of the leaf lies below it. It is
 * told from leaves by having no primitives, and may be loaded like them. */
#if RT_HAS_INSTANCES
#define BVH4_ROOM (2u * BVH4_STACK + 2u)
#define BVH4_LEAVE BVH4_EMPTY
#else
#define BVH4_ROOM BVH4_STACK
#endif

/* Maximum and minimum of floats by their bits as integers. The result is right unless both are negative. The compiler makes one
 * instruction of two of them (VIMNMX3 on Hopper), which saves an eighth of the time of all rays. Of two negative entry
 * distances the lesser is taken and of two negative exit distances the greater, so no box that is entered is missed. */
#define BVH4_MAX(a, b) as_float4(max(as_int4(a), as_int4(b)))
#define BVH4_MIN(a, b) as_float4(min(as_int4(a), as_int4(b)))

/* The address of a node's row 0, and the row at that address ^ bytes. The buffer begins with a line of the cache, so each node
 * is one. An axis's far planes stand at the address of its near planes ^ BVH4_FAR_*. */
#define BVH4_NODE(ctx, ref) ((ulong)(ctx)->bvh4_nodes + ((ulong)(ref) << 4))
#define BVH4_ROW(node, bytes) (*(const global float4 *)((node) ^ (ulong)(bytes)))
#define BVH4_NEAR_X(negative) ((negative) ? 48u : 0u)
#define BVH4_NEAR_Y(negative) ((negative) ? 64u : 16u)
#define BVH4_NEAR_Z(negative) ((negative) ? 80u : 32u)
#define BVH4_FAR_X 48u
#define BVH4_FAR_Y 80u
#define BVH4_FAR_Z 112u
#define BVH4_CHILDREN 96u

/* What the slab tests of all nodes need of a ray. The far side is widened here instead of in each node. That rounds twice more,
 * each time by half an ulp of origin / direction or of the distance. The slack of rt_prepare_for_boxes() and RT_WIDE have room
 * for both. */
typedef struct bvh4_ray {
    uint near_x, near_y, near_z; /* the rows of near planes, for BVH4_ROW */
    float wide_x, wide_y, wide_z, exit_x, exit_y, exit_z;
} bvh4_ray;

RT_INLINE bvh4_ray bvh4_prepare(const rt_rays *ray)
{
    bvh4_ray slab;
    slab.near_x = BVH4_NEAR_X(ray->ix < 0.0f);
    slab.near_y = BVH4_NEAR_Y(ray->iy < 0.0f);
    slab.near_z = BVH4_NEAR_Z(ray->iz < 0.0f);
    slab.wide_x = ray->ix * RT_WIDE;
    slab.wide_y = ray->iy * RT_WIDE;
    slab.wide_z = ray->iz * RT_WIDE;
    slab.exit_x = ray->far_x * RT_WIDE;
    slab.exit_y = ray->far_y * RT_WIDE;
    slab.exit_z = ray->far_z * RT_WIDE;
    return slab;
}

/* The slab test: the distances *in .. *out at which the ray is inside each child's box, before `t`. It misses a box if *in >
 * *out. near_x .. far_z: rows of planes. */
RT_INLINE void bvh4_slabs(const rt_rays *ray, const bvh4_ray *slab, float t, float4 near_x, float4 near_y, float4 near_z,
                          float4 far_x, float4 far_y, float4 far_z, float4 *in, float4 *out)
{
    const float4 ax = fma((float4)(ray->ix), near_x, (float4)(ray->near_x));
    const float4 ay = fma((float4)(ray->iy), near_y, (float4)(ray->near_y));
    const float4 az = fma((float4)(ray->iz), near_z, (float4)(ray->near_z));
    const float4 bx = fma((float4)(slab->wide_x), far_x, (float4)(slab->exit_x));
    const float4 by = fma((float4)(slab->wide_y), far_y, (float4)(slab->exit_y));
    const float4 bz = fma((float4)(slab->wide_z), far_z, (float4)(slab->exit_z));
    *in = BVH4_MAX(BVH4_MAX(ax, ay), BVH4_MAX(az, (float4)(ray->t_min)));
    *out = BVH4_MIN(BVH4_MIN(bx, by), BVH4_MIN(bz, (float4)(t)));
}

/* The entry distances of the children; INFINITY for those that the ray misses. */
RT_INLINE float4 bvh4_enter(const rt_rays *ray, const bvh4_ray *slab, float t, float4 near_x, float4 near_y, float4 near_z,
                            float4 far_x, float4 far_y, float4 far_z)
{
    float4 in, out;
    bvh4_slabs(ray, slab, t, near_x, near_y, near_z, far_x, far_y, far_z, &in, &out);
    return in <= out ? in : (float4)(INFINITY);
}

/* Returns x, but the compiler does not know that. It would otherwise merge the loads under a condition with the arithmetic
 * under the same condition, and rays of a warp on the other branch would wait for memory a second time. */
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

/* Swaps two children if the second is nearer. */
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

/* A stack entry: entry distance in the upper half, node reference in the lower. The lowest entry ends the traversal; its
 * distance is within reach of any ray. */
#define BVH4_ENTRY(t, child) ((ulong)as_uint(t) << 32 | (child))
#define BVH4_LOWEST BVH4_ENTRY(-INFINITY, BVH4_DONE)

/* What changes for a ray while it is in an instance. */
typedef struct bvh4_place {
    bvh4_ray slab;
#if RT_HAS_INSTANCES
    rt_rays ray;
    rt_visit visit;
#endif
} bvh4_place;
#if RT_HAS_INSTANCES
#define BVH4_RAY(place, world) (&(place)->ray)
#else
#define BVH4_RAY(place, world) (world)
#endif

RT_INLINE void bvh4_place_in_world(const rt_rays *world, bvh4_place *place)
{
    place->slab = bvh4_prepare(world);
#if RT_HAS_INSTANCES
    place->ray = *world;
    place->visit.instance = -1;
#endif
}

typedef ulong rt_step_entry;
typedef bvh4_place rt_step_ray;
#define RT_STEP_STACK_SIZE (BVH4_ROOM + 1u)
#define RT_STEP_DONE BVH4_DONE
#define RT_STEP_IS_LEAF(at) ((at) >= BVH4_LEAF)
RT_INLINE uint rt_begin_steps(uint root, const rt_rays *ray, rt_step_ray *step_ray, rt_step_entry *stack, uint *top)
{
    bvh4_place_in_world(ray, step_ray);
    stack[0] = BVH4_LOWEST;
    *top = 1u;
    return BVH4_NODE_REF(root);
}

#endif
#endif
#endif
