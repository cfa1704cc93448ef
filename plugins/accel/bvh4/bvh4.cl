/* bvh4.cl -- one ray against four boxes at once (RT_LANES 1), or a packet of rays against one box after the other.
 *
 * Made for GPUs. A turn of the loop is one item of each ray of a warp, a node or two triangles: whatever it is for whom, all of
 * it is fetched before anything is computed, so the warp waits once a turn, and no ray waits for the end of another's leaf. The
 * longest ray of a warp, which decides over small pictures, takes as many turns as it has nodes and pairs of triangles.
 *
 * 128 bytes a node; 71 registers on an H200, so 28 warps a multiprocessor; a stack of 8 bytes an entry (any hit: 4) in local
 * memory, whose lowest entry says that nothing is left. Measured there, geometric means over four scenes and three kinds of rays,
 * at 1024x768 (at 3840x2160): 1.08 (0.98) of leaves in a loop of their own; 1.3 (1.06) where single rays meet hundreds of triangles;
 * 1.10 of fetching triangles only when nodes are done. No gain: loads by inline PTX, prefetching what is put off, one triangle a turn
 * (0.9), a node and two triangles a turn (0.88: nodes are visited that the triangles would have hidden), leaves that wait until
 * several of a warp have one (0.94 to 0.86), constants of the ray pinned to registers, nodes of eight (0.93, leaves in a loop). Leaves
 * put off until all of a warp have one (Aila, Laine 2009) are better at 3840x2160 (1.04) and worse at 1024x768 (0.94).
 *
 * Rays that keep together go by warps (RT_TRAVERSE_WARP): with one ray a work-item 52 registers, 36 warps a multiprocessor, with two
 * 93 and 20. */
#if RT_LANES == 1
#if RT_ANY_HIT
#define BVH4_PUSHED uint
#define BVH4_RETURN_TOP() return stack[--*top]
#else
#define BVH4_PUSHED ulong
#define BVH4_RETURN_TOP()                                                                                                        \
    {                                                                                                                            \
        ulong pushed;                                                                                                            \
        do pushed = stack[--*top];                                                                                               \
        while (as_float((uint)(pushed >> 32)) > hit->t);                                                                         \
        return (uint)pushed;                                                                                                     \
    }
#endif
/* A turn: the node or the leaf `at`. Returns what comes next. */
RT_INLINE uint RT_CAT(RT_TRAVERSE, _step)(const rt_ctx *ctx, uint at, const rt_rays *ray, const bvh4_ray *own, rt_hits *hit,
                                          BVH4_PUSHED *stack, uint *top)
{
    const uint is_leaf = at >> 31, first = BVH4_LEAF_FIRST(at), count = BVH4_LEAF_COUNT(at);
    /* Rows a, b, c of a node's near planes or of the first triangle; d, e, f of its far planes or of the second. */
    float4 a, b, c, d, e, f;
    uint4 child;
    if (!is_leaf) {
        const ulong node = BVH4_NODE(ctx, at);
        a = BVH4_ROW(node, own->near_x);
        b = BVH4_ROW(node, own->near_y);
        c = BVH4_ROW(node, own->near_z);
        d = BVH4_ROW(node, own->near_x ^ BVH4_RAY_SPACE_X);
        e = BVH4_ROW(node, own->near_y ^ BVH4_RAY_SPACE_Y);
        f = BVH4_ROW(node, own->near_z ^ BVH4_RAY_SPACE_Z);
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
        BVH4_RETURN_TOP();
    }
    RT_COUNT_VISIT(hit, 1u);
    const float4 entry = bvh4_enter(ray, own, hit->t, a, b, c, d, e, f);
#if RT_ANY_HIT
    /* Order is worth nothing here: the last child that is met goes first. */
    uint next = BVH4_EMPTY;
#define BVH4_TAKE(k)                                                                                                             \
    if (entry.s##k < INFINITY) {                                                                                                 \
        if (next != BVH4_EMPTY) {                                                                                              \
            stack[*top] = next;                                                                                                  \
            if (RT_STACK_OK(*top, BVH4_STACK, hit)) ++*top;                                                                      \
        }                                                                                                                        \
        next = child.s##k;                                                                                                       \
    }
    BVH4_TAKE(0)
    BVH4_TAKE(1)
    BVH4_TAKE(2)
    BVH4_TAKE(3)
#undef BVH4_TAKE
    if (next != BVH4_EMPTY) return next;
    BVH4_RETURN_TOP();
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
    BVH4_RETURN_TOP();
#endif
}
#undef BVH4_RETURN_TOP
#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
#if RT_LANES == 1
    BVH4_PUSHED stack[BVH4_STACK + 1];
    stack[0] = (BVH4_PUSHED)BVH4_LOWEST;
    uint top = 1u, at = BVH4_NODE_REF(root);
    const bvh4_ray own = bvh4_prepare(ray);
    while (at != BVH4_DONE && RT_MAY_GO_ON(hit)) at = RT_CAT(RT_TRAVERSE, _step)(ctx, at, ray, &own, hit, stack, &top);
#else
    uint top = 0, at = BVH4_NODE_REF(root);
    /* Near children go first by the signs of the direction, on which the lanes mostly agree: last onto the stack. */
    const uint far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u);
    vfloat stack_t[BVH4_STACK];
    uint stack_node[BVH4_STACK];
    uint inside = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); /* lanes in the node, for counting programs */
    for (;;) {
        if (at & BVH4_LEAF) {
            const uint first = BVH4_LEAF_FIRST(at), count = BVH4_LEAF_COUNT(at);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, inside);
#define BVH4_NUMBER(k) ((const global float *)((ulong)ctx->bvh4_nodes + ((ulong)(at ^ (k)) << 4)))[slot]
            for (uint i = 0; i < 4u; ++i) {
                const uint slot = i ^ far_first, child = as_uint(BVH4_NUMBER(6u));
                if (child == BVH4_EMPTY) continue;
                vfloat entry;
                const vmask in = rt_enter_bounds(rt_vfloat(BVH4_NUMBER(0u)), rt_vfloat(BVH4_NUMBER(1u)), rt_vfloat(BVH4_NUMBER(2u)),
                                                 rt_vfloat(BVH4_NUMBER(3u)), rt_vfloat(BVH4_NUMBER(4u)), rt_vfloat(BVH4_NUMBER(5u)),
                                                 ray, hit, &entry);
                if (!rt_any(in)) continue;
                stack_node[top] = child;
                stack_t[top] = rt_select(in, entry, RT_INFINITY);
                if (RT_STACK_OK(top + 1u, BVH4_STACK, hit)) ++top;
            }
#undef BVH4_NUMBER
        }
        do {
            if (top == 0u) return;
            --top;
            inside = rt_bits(RT_MASK(stack_t[top] <= hit->t));
        } while (inside == 0u);
        at = stack_node[top];
    }
#endif
}

#ifdef RT_TRAVERSE_REQUEUED
/* Each work-item takes an entry of the stack that all share, the topmost being the nearest, tests the node's children or the leaf,
 * and puts back what is met. While room is short only one is taken: then BVH4_STACK more are enough. */
void RT_TRAVERSE_REQUEUED(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit, local rt_requeue_scratch *shared)
{
    const uint item = (uint)get_local_id(0);
    const bvh4_ray own = bvh4_prepare(ray);
    if (item == 0u) {
        shared->stack[0] = BVH4_ENTRY(0.0f, BVH4_NODE_REF(root));
        shared->put[0] = 0u;
        shared->nearest = as_uint(hit->t);
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint top = 1u, turn = 0u; top != 0u; turn ^= 1u) {
        const uint room = (uint)max(1, ((int)BVH4_LONG_STACK - (int)(BVH4_STACK + top)) / 3);
        const uint taken = min(min(top, RT_REQUEUE_ITEMS), room);
        const ulong entry = shared->stack[top - 1u - min(item, taken - 1u)];
        const float nearest = as_float(shared->nearest);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (item == 0u) shared->put[turn ^ 1u] = 0u;
        top -= taken;
#if RT_ANY_HIT
        const bool goes = item < taken && nearest != 0.0f;
        if (nearest == 0.0f) top = 0u;
#else
        const bool goes = item < taken && as_float((uint)(entry >> 32)) <= nearest;
        if (nearest < hit->t) { /* another's; what is as near must still be found, for the lower number wins */
            hit->t = as_float(as_uint(nearest) + 1u);
            hit->prim = hit->leaf = hit->instance = -1;
        }
#endif
        const uint at = (uint)entry;
        if (goes && (at & BVH4_LEAF)) {
            const uint first = BVH4_LEAF_FIRST(at), count = BVH4_LEAF_COUNT(at);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (hit->t < 0.0f) atomic_min(&shared->nearest, 0u);
#else
            if (hit->leaf != -1) atomic_min(&shared->nearest, as_uint(hit->t));
#endif
        } else if (goes) {
            const ulong node = BVH4_NODE(ctx, at);
            const float4 entries =
                bvh4_enter(ray, &own, hit->t, BVH4_ROW(node, own.near_x), BVH4_ROW(node, own.near_y), BVH4_ROW(node, own.near_z),
                           BVH4_ROW(node, own.near_x ^ BVH4_RAY_SPACE_X), BVH4_ROW(node, own.near_y ^ BVH4_RAY_SPACE_Y),
                           BVH4_ROW(node, own.near_z ^ BVH4_RAY_SPACE_Z));
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
                local ulong *to = shared->stack + top + atomic_add(&shared->put[turn], more);
                if (t3 < INFINITY) *to++ = BVH4_ENTRY(t3, child3);
                if (t2 < INFINITY) *to++ = BVH4_ENTRY(t2, child2);
                if (t1 < INFINITY) *to++ = BVH4_ENTRY(t1, child1);
                *to = BVH4_ENTRY(t0, child0);
            }
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        top += shared->put[turn];
    }
}
#endif

#ifdef RT_TRAVERSE_WARP
/* What any ray of the warp enters all of it visit, so addresses, branches and the stack are the same for all. Branches are by votes,
 * of which the compiler knows that: they need not be guarded, nor ways joined again. A work-item keeps its own distances on the
 * stack, those of the nearer of its rays. The nearest child is taken first; of three or more the others are in no order. */
void RT_TRAVERSE_WARP(const rt_ctx *ctx, uint root, uint octant, const rt_rays *rays, rt_hits *hits)
{
    BVH4_PUSHED stack[BVH4_STACK + 1];
    stack[0] = (BVH4_PUSHED)BVH4_LOWEST;
    bvh4_ray own[RT_RAYS_PER_ITEM];
    RT_FOR_EACH_RAY_OF_ITEM(i) own[i] = bvh4_prepare(rays + i);
    const uint near_x = BVH4_NEAR_X(octant & 1u), near_y = BVH4_NEAR_Y(octant & 2u), near_z = BVH4_NEAR_Z(octant & 4u);
    uint top = 1u, at = BVH4_NODE_REF(root);
    for (;;) {
        bool found = false;
        uint next = BVH4_DONE;
        if (rt_subgroup_any(at >= BVH4_LEAF)) {
            if (rt_subgroup_any(at == BVH4_DONE)) return;
            const uint end = BVH4_LEAF_FIRST(at) + BVH4_LEAF_COUNT(at);
            for (uint k = BVH4_LEAF_FIRST(at); rt_subgroup_any(k < end); ++k) {
#if RT_TRIANGLES_ONLY
                const rt_loaded_prim leaf = rt_load_leaf(ctx->leaves + k);
                RT_FOR_EACH_RAY_OF_ITEM(i) RT_LOADED_PRIM(ctx, &leaf, k, rays + i, hits + i);
#else
                RT_FOR_EACH_RAY_OF_ITEM(i) RT_LEAF(ctx, k, rays + i, hits + i);
#endif
            }
#if RT_ANY_HIT
            bool seeks = false;
            RT_FOR_EACH_RAY_OF_ITEM(i) seeks |= hits[i].t >= 0.0f;
            if (!rt_subgroup_any(seeks)) return;
#endif
        } else {
            const ulong node = BVH4_NODE(ctx, at);
            const float4 a = BVH4_ROW(node, near_x), b = BVH4_ROW(node, near_y), c = BVH4_ROW(node, near_z),
                         d = BVH4_ROW(node, near_x ^ BVH4_RAY_SPACE_X), e = BVH4_ROW(node, near_y ^ BVH4_RAY_SPACE_Y),
                         f = BVH4_ROW(node, near_z ^ BVH4_RAY_SPACE_Z);
            const uint4 child = as_uint4(BVH4_ROW(node, BVH4_CHILDREN));
            float4 in[RT_RAYS_PER_ITEM], out[RT_RAYS_PER_ITEM];
            RT_FOR_EACH_RAY_OF_ITEM(i) bvh4_slabs(rays + i, own + i, hits[i].t, a, b, c, d, e, f, in + i, out + i);
#if RT_ANY_HIT
#define BVH4_KEEP(k)                                                                                                             \
    if (found) {                                                                                                                 \
        stack[top] = next;                                                                                                       \
        if (RT_STACK_OK(top, BVH4_STACK, hits)) ++top;                                                                           \
    }                                                                                                                            \
    next = child.s##k;
#else
            float nearest = INFINITY;
#define BVH4_KEEP(k)                                                                                                             \
    float entry = INFINITY;                                                                                                      \
    RT_FOR_EACH_RAY_OF_ITEM(i) entry = in[i].s##k <= out[i].s##k ? fmin(entry, in[i].s##k) : entry;                                      \
    const bool nearer = !found || rt_subgroup_any(entry < nearest);                                                                      \
    if (found) {                                                                                                                 \
        stack[top] = nearer ? BVH4_ENTRY(nearest, next) : BVH4_ENTRY(entry, child.s##k);                                         \
        if (RT_STACK_OK(top, BVH4_STACK, hits)) ++top;                                                                           \
    }                                                                                                                            \
    nearest = nearer ? entry : nearest;                                                                                          \
    next = nearer ? child.s##k : next;
#endif
#define BVH4_TAKE(k)                                                                                                             \
    {                                                                                                                            \
        bool met = false;                                                                                                        \
        RT_FOR_EACH_RAY_OF_ITEM(i) met |= in[i].s##k <= out[i].s##k;                                                                     \
        if (rt_subgroup_any(met)) {                                                                                                      \
            BVH4_KEEP(k)                                                                                                         \
            found = true;                                                                                                        \
        }                                                                                                                        \
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
            ulong pushed;
            do pushed = stack[--top];
            while (!rt_subgroup_any(as_float((uint)(pushed >> 32)) <= reach));
            next = (uint)pushed;
#endif
        }
        at = next;
    }
}
#endif
#if RT_LANES == 1
#undef BVH4_PUSHED
#endif
