/* bvh4.cl -- traversal of a tree of four children a node: one ray against four boxes at once (RT_LANES 1), or a packet of rays.
 *
 * Wald, Benthin, Boulos 2008, "Getting Rid of Packets". Made for GPUs. A step of the loop is a node or two triangles for each
 * ray of a warp. All of it is fetched before anything is computed, whichever it is for which ray. So the warp waits for memory
 * once a step, and no ray waits for the end of another's leaf. The longest ray of a warp decides over small pictures. It takes
 * as many steps as it has nodes and pairs of triangles.
 *
 * 128 bytes a node. Stack: 8 bytes an entry (any hit: 4) in local memory; its lowest entry ends the traversal. 71 registers on
 * an H200, so 28 warps a multiprocessor.
 *
 * Measured there at 1024x768 (in brackets: 3840x2160), geometric means over four scenes and three kinds of rays. This loop is
 *   1.08 (0.98)  times as fast as one with leaves in an inner loop
 *   1.3 (1.06)   times as fast where single rays meet hundreds of triangles
 *   1.10         times as fast as fetching triangles only after the nodes are tested.
 * Tried without gain (relative speed): loads by inline PTX; prefetching deferred children; one triangle a step (0.9); a node
 * and two triangles a step (0.88: it visits nodes that the triangles would have hidden); leaves that wait until several rays of
 * a warp have one (0.94 to 0.86); ray constants pinned to registers; nodes of eight children (0.93, leaves in a loop). Leaves
 * that wait until all rays of a warp have one (Aila, Laine 2009) are better at 3840x2160 (1.04) and worse at 1024x768 (0.94).
 *
 * Coherent rays can be traced warp by warp (RT_TRAVERSE_WARP). With one ray a work-item that takes 52 registers, 36 warps a
 * multiprocessor; with two rays 93 and 20. */
#if RT_LANES == 1
#if RT_ANY_HIT
#define BVH4_STACK_ENTRY uint
#define BVH4_RETURN_POPPED() return stack[--*top]
#else
#define BVH4_STACK_ENTRY ulong
#define BVH4_RETURN_POPPED()                                                                                                   \
    {                                                                                                                          \
        ulong popped;                                                                                                          \
        do popped = stack[--*top];                                                                                             \
        while (as_float((uint)(popped >> 32)) > hit->t);                                                                       \
        return (uint)popped;                                                                                                   \
    }
#endif
/* One step: visits the node or leaf `ref`. Returns the next node reference. */
RT_INLINE uint RT_CAT(RT_TRAVERSE, _step)(const rt_ctx *ctx, uint ref, const rt_rays *ray, const bvh4_ray *slab, rt_hits *hit,
                                          BVH4_STACK_ENTRY *stack, uint *top)
{
    const uint is_leaf = ref >> 31, first = BVH4_LEAF_FIRST(ref), count = BVH4_LEAF_COUNT(ref);
    /* a, b, c: a node's rows of near planes, or the first triangle. d, e, f: its rows of far planes, or the second triangle. */
    float4 a, b, c, d, e, f;
    uint4 child;
    if (!is_leaf) {
        const ulong node = RT_NODE(ray, BVH4_NODE(ctx, ref));
        a = BVH4_ROW(node, slab->near_x);
        b = BVH4_ROW(node, slab->near_y);
        c = BVH4_ROW(node, slab->near_z);
        d = BVH4_ROW(node, slab->near_x ^ BVH4_FAR_X);
        e = BVH4_ROW(node, slab->near_y ^ BVH4_FAR_Y);
        f = BVH4_ROW(node, slab->near_z ^ BVH4_FAR_Z);
        child = as_uint4(BVH4_ROW(node, BVH4_CHILDREN));
    }
#if RT_TRIANGLES_ONLY
    else {
        const global float4 *row = (const global float4 *)(ctx->leaves + first);
        a = row[0];
        b = row[1];
        c = row[2];
        if (count > 1u) {
            d = row[3];
            e = row[4];
            f = row[5];
        }
    }
#endif
    if (bvh4_hidden(is_leaf)) {
#if RT_TRIANGLES_ONLY
        const rt_loaded_prim one = {a, b, c};
        RT_LOADED_PRIM(ctx, &one, first, ray, hit);
        if (count > 1u) {
            const rt_loaded_prim two = {d, e, f};
            RT_LOADED_PRIM(ctx, &two, first + 1u, ray, hit);
        }
        const uint done = 2u;
#else
        for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
        const uint done = count;
#endif
#if RT_ANY_HIT
        if (hit->t < 0.0f) return BVH4_DONE;
#endif
        if (count > done) return BVH4_MAKE_LEAF(first + done, count - done);
        BVH4_RETURN_POPPED();
    }
    RT_COUNT_VISIT(hit, 1u);
    RT_COUNT_BOXES(hit, 4u);
    const float4 entry = bvh4_enter(ray, slab, hit->t, a, b, c, d, e, f);
#if RT_ANY_HIT
    /* Order does not matter here: the last child that is entered is visited next. */
    uint next = BVH4_EMPTY;
#define BVH4_TAKE(k)                                                                                                           \
    if (entry.s##k < INFINITY) {                                                                                               \
        if (next != BVH4_EMPTY) {                                                                                              \
            stack[*top] = next;                                                                                                \
            if (RT_STACK_OK(*top, BVH4_STACK, hit)) ++*top;                                                                    \
        }                                                                                                                      \
        next = child.s##k;                                                                                                     \
    }
    BVH4_TAKE(0)
    BVH4_TAKE(1)
    BVH4_TAKE(2)
    BVH4_TAKE(3)
#undef BVH4_TAKE
    if (next != BVH4_EMPTY) return next;
    BVH4_RETURN_POPPED();
#else
    float t0 = entry.s0, t1 = entry.s1, t2 = entry.s2, t3 = entry.s3;
    uint child0 = child.s0, child1 = child.s1, child2 = child.s2, child3 = child.s3;
    bvh4_order(&t0, &child0, &t1, &child1);
    bvh4_order(&t2, &child2, &t3, &child3);
    bvh4_order(&t0, &child0, &t2, &child2);
    if (fmin(fmin(t1, t2), t3) < INFINITY) {
        bvh4_order(&t1, &child1, &t3, &child3);
        bvh4_order(&t1, &child1, &t2, &child2);
        const uint more = 1u + (t2 < INFINITY ? 1u : 0u) + (t3 < INFINITY ? 1u : 0u);
        if (RT_STACK_OK(*top + more, BVH4_STACK + 1u, hit)) {
            *top += more;
            stack[*top - 1u] = BVH4_ENTRY(t1, child1);
            if (t2 < INFINITY) stack[*top - 2u] = BVH4_ENTRY(t2, child2);
            if (t3 < INFINITY) stack[*top - 3u] = BVH4_ENTRY(t3, child3);
        }
    }
    if (t0 < INFINITY) return child0;
    BVH4_RETURN_POPPED();
#endif
}
#undef BVH4_RETURN_POPPED
#endif

#if RT_LANES > 1
#define RT_PACKET_STACK_SIZE BVH4_STACK
#define RT_PACKET_RAYS uint
#include "cl/lanes/packet_traversal.h"

/* Pushes the children that are entered, by their slots. *far_first has the bits of the slot that is visited last. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _children)(const rt_ctx *ctx, uint ref, const rt_rays *ray, const uint *far_first, rt_hits *hit,
                                              rt_packet_stack *stack)
{
#define BVH4_NUMBER(row) ((const global float *)((ulong)ctx->bvh4_nodes + ((ulong)(ref ^ (row)) << 4)))[slot]
    for (uint i = 0; i < 4u; ++i) {
        const uint slot = i ^ *far_first, child = as_uint(BVH4_NUMBER(6u));
        if (child == BVH4_EMPTY) continue;
        vfloat entry;
        const vmask in = rt_enter_bounds(rt_vfloat(BVH4_NUMBER(0u)), rt_vfloat(BVH4_NUMBER(1u)), rt_vfloat(BVH4_NUMBER(2u)),
                                         rt_vfloat(BVH4_NUMBER(3u)), rt_vfloat(BVH4_NUMBER(4u)), rt_vfloat(BVH4_NUMBER(5u)), ray, hit,
                                         &entry);
        if (rt_any(in)) rt_push_packet(stack, child, rt_select(in, entry, RT_INFINITY), hit);
    }
#undef BVH4_NUMBER
}
#undef RT_PACKET_STACK_SIZE
#undef RT_PACKET_RAYS
#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
#if RT_LANES == 1
    BVH4_STACK_ENTRY stack[BVH4_STACK + 1];
    stack[0] = (BVH4_STACK_ENTRY)BVH4_LOWEST;
    uint top = 1u, ref = BVH4_NODE_REF(root);
    const bvh4_ray slab = bvh4_prepare(ray);
    while (ref != BVH4_DONE && RT_MAY_GO_ON(hit)) ref = RT_CAT(RT_TRAVERSE, _step)(ctx, ref, ray, &slab, hit, stack, &top);
#else
    /* Bits 0 and 1 of a slot tell on which side of the node the child lies in x and y. */
    const uint far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u);
    RT_CAT(RT_TRAVERSE, _packet)(ctx, BVH4_NODE_REF(root), ray, &far_first, hit);
#endif
}

#ifdef RT_TRAVERSE_REQUEUED
/* All work-items share one stack. In each round each pops an entry, of the topmost ones, which are the nearest; tests the
 * node's children or the leaf; and pushes the children that are entered. While room is short only one entry is popped in a
 * round: then BVH4_STACK more entries are enough. */
void RT_TRAVERSE_REQUEUED(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit, local rt_requeue_scratch *shared)
{
    const uint item = (uint)get_local_id(0);
    const bvh4_ray slab = bvh4_prepare(ray);
    if (item == 0u) {
        shared->stack[0] = BVH4_ENTRY(0.0f, BVH4_NODE_REF(root));
        shared->pushed[0] = 0u;
        shared->nearest = as_uint(hit->t);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint top = 1u, parity = 0u; top != 0u; parity ^= 1u) {
        const uint room = (uint)max(1, ((int)BVH4_LONG_STACK - (int)(BVH4_STACK + top)) / 3);
        const uint taken = min(min(top, RT_REQUEUE_ITEMS), room);
        const ulong entry = shared->stack[top - 1u - min(item, taken - 1u)];
        const float nearest = as_float(shared->nearest);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item == 0u) shared->pushed[parity ^ 1u] = 0u;
        top -= taken;
#if RT_ANY_HIT
        const bool is_active = item < taken && nearest != 0.0f;
        if (nearest == 0.0f) top = 0u;
#else
        const bool is_active = item < taken && as_float((uint)(entry >> 32)) <= nearest;
        if (nearest < hit->t) { /* another's hit; a primitive at the same distance must still be found, since the lower number is the hit */
            hit->t = as_float(as_uint(nearest) + 1u);
            hit->prim = hit->leaf = hit->instance = -1;
        }
#endif
        const uint ref = (uint)entry;
        if (is_active && (ref & BVH4_LEAF)) {
            const uint first = BVH4_LEAF_FIRST(ref), count = BVH4_LEAF_COUNT(ref);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (hit->t < 0.0f) atomic_min(&shared->nearest, 0u);
#else
            if (hit->leaf != -1) atomic_min(&shared->nearest, as_uint(hit->t));
#endif
        } else if (is_active) {
            const ulong node = BVH4_NODE(ctx, ref);
            const float4 entries =
                bvh4_enter(ray, &slab, hit->t, BVH4_ROW(node, slab.near_x), BVH4_ROW(node, slab.near_y), BVH4_ROW(node, slab.near_z),
                           BVH4_ROW(node, slab.near_x ^ BVH4_FAR_X), BVH4_ROW(node, slab.near_y ^ BVH4_FAR_Y),
                           BVH4_ROW(node, slab.near_z ^ BVH4_FAR_Z));
            const uint4 child = as_uint4(BVH4_ROW(node, BVH4_CHILDREN));
            float t0 = entries.s0, t1 = entries.s1, t2 = entries.s2, t3 = entries.s3;
            uint child0 = child.s0, child1 = child.s1, child2 = child.s2, child3 = child.s3;
            bvh4_order(&t0, &child0, &t1, &child1);
            bvh4_order(&t2, &child2, &t3, &child3);
            bvh4_order(&t0, &child0, &t2, &child2);
            bvh4_order(&t1, &child1, &t3, &child3);
            bvh4_order(&t1, &child1, &t2, &child2);
            const uint more = (t0 < INFINITY ? 1u : 0u) + (t1 < INFINITY ? 1u : 0u) + (t2 < INFINITY ? 1u : 0u) +
                              (t3 < INFINITY ? 1u : 0u);
            if (more != 0u) {
                local ulong *to = shared->stack + top + atomic_add(&shared->pushed[parity], more);
                if (t3 < INFINITY) *to++ = BVH4_ENTRY(t3, child3);
                if (t2 < INFINITY) *to++ = BVH4_ENTRY(t2, child2);
                if (t1 < INFINITY) *to++ = BVH4_ENTRY(t1, child1);
                *to = BVH4_ENTRY(t0, child0);
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        top += shared->pushed[parity];
    }
}
#endif

#ifdef RT_TRAVERSE_WARP
/* All rays of the warp visit each node that any of them enters, so addresses, branches and the stack are uniform. Branches are
 * on votes, which the compiler knows to be uniform: it neither guards them nor joins their paths again. A work-item keeps the
 * entry distance of the nearer of its rays on its stack. The nearest child is visited next; of three or more the others are in
 * no order. */
void RT_TRAVERSE_WARP(const rt_ctx *ctx, uint root, uint octant, const rt_rays *rays, rt_hits *hits)
{
    BVH4_STACK_ENTRY stack[BVH4_STACK + 1];
    stack[0] = (BVH4_STACK_ENTRY)BVH4_LOWEST;
    bvh4_ray slab[RT_RAYS_PER_ITEM];
    RT_FOR_EACH_RAY_OF_ITEM(i) slab[i] = bvh4_prepare(rays + i);
    const uint near_x = BVH4_NEAR_X(octant & 1u), near_y = BVH4_NEAR_Y(octant & 2u), near_z = BVH4_NEAR_Z(octant & 4u);
    uint top = 1u, ref = BVH4_NODE_REF(root);
    for (;;) {
        bool found = false;
        uint next = BVH4_DONE;
        if (rt_subgroup_any(ref >= BVH4_LEAF)) {
            if (rt_subgroup_any(ref == BVH4_DONE)) return;
            const uint end = BVH4_LEAF_FIRST(ref) + BVH4_LEAF_COUNT(ref);
            for (uint k = BVH4_LEAF_FIRST(ref); rt_subgroup_any(k < end); ++k) {
#if RT_TRIANGLES_ONLY
                const rt_loaded_prim leaf = rt_load_leaf(ctx->leaves + k);
                RT_FOR_EACH_RAY_OF_ITEM(i) RT_LOADED_PRIM(ctx, &leaf, k, rays + i, hits + i);
#else
                RT_FOR_EACH_RAY_OF_ITEM(i) RT_LEAF(ctx, k, rays + i, hits + i);
#endif
            }
#if RT_ANY_HIT
            bool searching = false;
            RT_FOR_EACH_RAY_OF_ITEM(i) searching |= hits[i].t >= 0.0f;
            if (!rt_subgroup_any(searching)) return;
#endif
        } else {
            const ulong node = BVH4_NODE(ctx, ref);
            const float4 a = BVH4_ROW(node, near_x), b = BVH4_ROW(node, near_y), c = BVH4_ROW(node, near_z),
                         d = BVH4_ROW(node, near_x ^ BVH4_FAR_X), e = BVH4_ROW(node, near_y ^ BVH4_FAR_Y),
                         f = BVH4_ROW(node, near_z ^ BVH4_FAR_Z);
            const uint4 child = as_uint4(BVH4_ROW(node, BVH4_CHILDREN));
            float4 in[RT_RAYS_PER_ITEM], out[RT_RAYS_PER_ITEM];
            RT_FOR_EACH_RAY_OF_ITEM(i) bvh4_slabs(rays + i, slab + i, hits[i].t, a, b, c, d, e, f, in + i, out + i);
#if RT_ANY_HIT
#define BVH4_KEEP(k)                                                                                                           \
    if (found) {                                                                                                               \
        stack[top] = next;                                                                                                     \
        if (RT_STACK_OK(top, BVH4_STACK, hits)) ++top;                                                                         \
    }                                                                                                                          \
    next = child.s##k;
#else
            float nearest = INFINITY;
#define BVH4_KEEP(k)                                                                                                           \
    float entry = INFINITY;                                                                                                    \
    RT_FOR_EACH_RAY_OF_ITEM(i) entry = in[i].s##k <= out[i].s##k ? fmin(entry, in[i].s##k) : entry;                            \
    const bool nearer = !found || rt_subgroup_any(entry < nearest);                                                            \
    if (found) {                                                                                                               \
        stack[top] = nearer ? BVH4_ENTRY(nearest, next) : BVH4_ENTRY(entry, child.s##k);                                       \
        if (RT_STACK_OK(top, BVH4_STACK, hits)) ++top;                                                                         \
    }                                                                                                                          \
    nearest = nearer ? entry : nearest;                                                                                        \
    next = nearer ? child.s##k : next;
#endif
#define BVH4_TAKE(k)                                                                                                           \
    {                                                                                                                          \
        bool entered = false;                                                                                                  \
        RT_FOR_EACH_RAY_OF_ITEM(i) entered |= in[i].s##k <= out[i].s##k;                                                       \
        if (rt_subgroup_any(entered)) {                                                                                        \
            BVH4_KEEP(k)                                                                                                       \
            found = true;                                                                                                      \
        }                                                                                                                      \
    }
            BVH4_TAKE(0)
            BVH4_TAKE(1)
            BVH4_TAKE(2)
            BVH4_TAKE(3)
#undef BVH4_TAKE
#undef BVH4_KEEP
        }
        if (!found) {
#if RT_ANY_HIT
            next = stack[--top];
#else
            float reach = hits[0].t;
            RT_FOR_EACH_RAY_OF_ITEM(i) reach = fmax(reach, hits[i].t);
            ulong popped;
            do popped = stack[--top];
            while (!rt_subgroup_any(as_float((uint)(popped >> 32)) <= reach));
            next = (uint)popped;
#endif
        }
        ref = next;
    }
}
#endif
#if RT_LANES == 1
#undef BVH4_STACK_ENTRY
#endif
