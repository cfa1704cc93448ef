/* bvh8.cl -- a tree of eight children a node, and ways to go down it for rays that have more or less in common.
 *
 * Rays of a packet whose directions agree in sign go by their bounds: intervals of their origins and of their reciprocal
 * directions give one slab test that no ray of the packet can beat (Reshetov, Soupikov, Hurley 2005, "Multi-Level Ray Tracing
 * Algorithm"; Boulos, Wald, Shirley 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets"). Before a leaf the
 * rays themselves are tested, and before a node too where the bounds are wide. A packet alone tests all eight children at once,
 * BVH8_INTERVAL_PACKET. The packets of a stream go together, BVH8_INTERVAL_STREAM: one box at a time, the bounds of a packet in each lane, so
 * that a node is fetched and decided on once for all who come to it, a fifth to a tenth as often. A packet whose rays are of two
 * octants goes twice, each time with the rays of one.
 *
 * Where there are more octants the rays part. They are tested together against one box after the other, or, BVH8_SINGLE, go by
 * turns, each its own way: where a tree outgrows the caches, rays that share few nodes only fetch more of them together.
 *
 * A program of one lane takes the nearest child and puts the others off in the order of their distances. Most nodes leave one or
 * two children, and branching on their number costs less than sorting vectors of eight: a network in registers took a tenth
 * longer, and so did putting all off in the order of the slots by compressing stores. Where any hit will do, order is worth
 * nothing: nearly as few nodes are visited without it, each for less. */
#if RT_LANES == 1

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    uint top = 0, at = root;
    const ulong near_x = ray->ix < 0.0f ? 96u : 0u, near_y = ray->iy < 0.0f ? 128u : 32u, near_z = ray->iz < 0.0f ? 160u : 64u;
    const ulong far_x = 96u - near_x, far_y = 160u - near_y, far_z = 224u - near_z;
    const float8 ix = (float8)(ray->ix), iy = (float8)(ray->iy), iz = (float8)(ray->iz);
    /* The far side is widened here instead of in each node: that rounds twice more, each time by half an ulp of origin /
     * direction or of the distance, for which the slack of rt_prepare and RT_WIDE have room. */
    const float8 wide_x = ix * RT_WIDE, wide_y = iy * RT_WIDE, wide_z = iz * RT_WIDE;
    const float8 exit_x = (float8)(ray->far_x * RT_WIDE), exit_y = (float8)(ray->far_y * RT_WIDE),
                 exit_z = (float8)(ray->far_z * RT_WIDE);
#if RT_ANY_HIT
    uint stack[BVH8_STACK];
#else
    ulong stack[BVH8_STACK];
#endif
#define BVH8_PUSH(key)                                                                                                           \
    {                                                                                                                            \
        stack[top] = key;                                                                                                        \
        if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;                                                                       \
    }
    for (;;) {
        if (at & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(at), count = BVH8_LEAF_COUNT(at);
#if RT_CPU
            RT_COUNT_LEAVES(hit, count);
            RT_SINGLE_RAY_TEST(ctx, first, RT_SINGLE_RAY_CANDIDATES(ctx, first, count, ray, 0u), ray, 0u, hit, ray, hit);
#else
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#endif
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, 1u);
            const global char *node = (const global char *)(ctx->bvh8_nodes + at);
            const float8 ax = fma(ix, BVH8_ROW(node, near_x), (float8)(ray->near_x));
            const float8 ay = fma(iy, BVH8_ROW(node, near_y), (float8)(ray->near_y));
            const float8 az = fma(iz, BVH8_ROW(node, near_z), (float8)(ray->near_z));
            const float8 bx = fma(wide_x, BVH8_ROW(node, far_x), exit_x);
            const float8 by = fma(wide_y, BVH8_ROW(node, far_y), exit_y);
            const float8 bz = fma(wide_z, BVH8_ROW(node, far_z), exit_z);
            const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(ray->t_min)));
            const float8 out = rt_min(rt_min(bx, by), rt_min(bz, (float8)(hit->t)));
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                const global uint *child = (const global uint *)(node + 192);
#if RT_ANY_HIT
                at = child[rt_lowest(bits)];
                for (bits &= bits - 1u; bits != 0u; bits &= bits - 1u) BVH8_PUSH(child[rt_lowest(bits)])
                continue;
#else
                uint i = rt_lowest(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    at = child[i];
                    continue;
                }
                float entry[BVH8_WIDTH];
                vstore8(in, 0, entry);
                ulong key = BVH8_KEY(entry, child, i);
                i = rt_lowest(bits);
                bits &= bits - 1u;
                ulong other = BVH8_KEY(entry, child, i);
                ulong nearest = min(key, other), second = max(key, other);
                if (bits != 0u) {
                    i = rt_lowest(bits);
                    bits &= bits - 1u;
                    key = BVH8_KEY(entry, child, i);
                    other = min(key, second);
                    const uint base = top;
                    BVH8_PUSH(max(key, second))
                    second = max(other, nearest);
                    nearest = min(other, nearest);
                    for (; bits != 0u; bits &= bits - 1u) {
                        /* The farther ones go where they belong: between `base` and the top the farthest is lowest. */
                        key = BVH8_KEY(entry, child, rt_lowest(bits));
                        other = max(key, second);
                        key = min(key, second);
                        uint to = top;
                        for (; to > base && stack[to - 1u] < other; --to) stack[to] = stack[to - 1u];
                        stack[to] = other;
                        if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;
                        second = max(key, nearest);
                        nearest = min(key, nearest);
                    }
                }
                BVH8_PUSH(second)
                at = (uint)nearest;
                continue;
#endif
            }
        }
#if RT_ANY_HIT
        if (top == 0u) return;
        at = stack[--top];
#else
        ulong next;
        do {
            if (top == 0u) return;
            next = stack[--top];
        } while (as_float((uint)(next >> 32)) > hit->t);
        at = (uint)next;
#endif
    }
#undef BVH8_PUSH
}

#else

#define BVH8_ENTER RT_CAT(RT_TRAVERSE, _enter)
#define BVH8_INTERVAL_PACKET RT_CAT(RT_TRAVERSE, _interval_packet)
#define BVH8_INTERLEAVED RT_CAT(RT_TRAVERSE, _interleaved)
#define BVH8_INCOHERENT_PACKET RT_CAT(RT_TRAVERSE, _incoherent_packet)
#define BVH8_INTERVAL_STREAM RT_CAT(RT_TRAVERSE, _interval_stream)

/* Rays against the box of one child, whose rows are near_x .. far_z bytes from `box`. */
RT_INLINE uint BVH8_ENTER(const global char *box, ulong near_x, ulong near_y, ulong near_z, const rt_rays *ray, const rt_hits *hit)
{
    const vfloat ax = fma(ray->ix, BVH8_PLANE(box, near_x), ray->near_x), bx = fma(ray->ix, BVH8_PLANE(box, 96u - near_x), ray->far_x);
    const vfloat ay = fma(ray->iy, BVH8_PLANE(box, near_y), ray->near_y), by = fma(ray->iy, BVH8_PLANE(box, 160u - near_y), ray->far_y);
    const vfloat az = fma(ray->iz, BVH8_PLANE(box, near_z), ray->near_z), bz = fma(ray->iz, BVH8_PLANE(box, 224u - near_z), ray->far_z);
    const vfloat entry = rt_max(rt_max(ax, ay), rt_max(az, ray->t_min));
    return rt_bits(RT_MASK(entry <= rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, hit->t)));
}

/* A packet whose active directions are of one octant. */
RT_INLINE void BVH8_INTERVAL_PACKET(const rt_ctx *ctx, uint at, uint octant, const rt_rays *ray, rt_hits *hit)
{
    const vmask alive = RT_MASK(hit->t >= rt_vfloat(0.0f));
    float t_far = rt_greatest(hit->t);
    const ulong near_x = BVH8_NEAR(octant, 0), near_y = BVH8_NEAR(octant, 1), near_z = BVH8_NEAR(octant, 2);
    const ulong far_x = 96u - near_x, far_y = 160u - near_y, far_z = 224u - near_z;
    /* A plane p is met at (p - origin) / direction: no ray meets a near plane that lies before it earlier than the slowest would
     * from the foremost origin, nor leaves by a far plane later than the fastest from the hindmost. For planes that lie behind,
     * both are negative, and t_min is not, so 0 stands for it. Each as fma(1 / direction, p, -origin / direction), with the slack
     * of rt_prepare(). */
    bool wide = false;
#define BVH8_AXIS(x, turned)                                                                                                     \
    const float o_lo_##x = rt_least_of(alive, ray->o##x), o_hi_##x = rt_greatest_of(alive, ray->o##x);                           \
    const float i_lo_##x = rt_least_of(alive, ray->i##x), i_hi_##x = rt_greatest_of(alive, ray->i##x);                           \
    const float slow_##x = (turned) ? i_hi_##x : i_lo_##x, fast_##x = (turned) ? i_lo_##x : i_hi_##x;                            \
    const float in_##x = BVH8_DOWN(-((turned) ? o_lo_##x : o_hi_##x) * slow_##x);                                                \
    const float out_##x = BVH8_UP(-((turned) ? o_hi_##x : o_lo_##x) * fast_##x);                                                 \
    wide |= BVH8_WIDE(o_lo_##x, o_hi_##x, i_lo_##x, i_hi_##x);
    BVH8_AXIS(x, near_x != 0u)
    BVH8_AXIS(y, near_y != 32u)
    BVH8_AXIS(z, near_z != 64u)
#undef BVH8_AXIS

    /* Put off: entry distance in the upper half; node and slot, from which a leaf's box is found again, in the lower. */
    ulong stack[BVH8_STACK];
    const global char *node = (const global char *)(ctx->bvh8_nodes + at);
    uint top = 0, slot = 0;
    bool tested = true; /* whether `at` is known to be entered */
    for (;;) {
        if (at & BVH8_LEAF) {
            if (BVH8_ENTER(node + 4u * slot, near_x, near_y, near_z, ray, hit) != 0u) {
                const uint first = BVH8_LEAF_FIRST(at), count = BVH8_LEAF_COUNT(at);
                for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
                t_far = rt_greatest(hit->t);
#if RT_ANY_HIT
                if (t_far < 0.0f) return;
#endif
            }
        } else if (!wide || tested || BVH8_ENTER(node + 4u * slot, near_x, near_y, near_z, ray, hit) != 0u) {
            tested = false;
            RT_COUNT_VISIT(hit, rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))));
            node = (const global char *)(ctx->bvh8_nodes + at);
            const float8 ax = fma((float8)(slow_x), BVH8_ROW(node, near_x), (float8)(in_x));
            const float8 ay = fma((float8)(slow_y), BVH8_ROW(node, near_y), (float8)(in_y));
            const float8 az = fma((float8)(slow_z), BVH8_ROW(node, near_z), (float8)(in_z));
            const float8 bx = fma((float8)(fast_x), BVH8_ROW(node, far_x), (float8)(out_x));
            const float8 by = fma((float8)(fast_y), BVH8_ROW(node, far_y), (float8)(out_y));
            const float8 bz = fma((float8)(fast_z), BVH8_ROW(node, far_z), (float8)(out_z));
            const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(0.0f)));
            const float8 out = rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, (float8)(t_far));
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                const global uint *child = (const global uint *)(node + 192);
                slot = rt_lowest(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    at = child[slot];
                    continue;
                }
                float entry[BVH8_WIDTH];
                vstore8(in, 0, entry);
#define BVH8_NODE_REF(i) ((ulong)as_uint(entry[i]) << 32 | (at * 8u + (i)))
                bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, child[slot]);
                ulong nearest = BVH8_NODE_REF(slot);
                for (; bits != 0u; bits &= bits - 1u) {
                    const uint i = rt_lowest(bits);
                    bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, child[i]);
                    const ulong place = BVH8_NODE_REF(i);
                    stack[top] = max(place, nearest);
                    nearest = min(place, nearest);
                    if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;
                }
                slot = (uint)nearest & 7u;
                at = child[slot];
                continue;
            }
        }
        ulong next;
        do {
            if (top == 0u) return;
            next = stack[--top];
        } while (as_float((uint)(next >> 32)) > t_far);
        slot = (uint)next & 7u;
        node = (const global char *)(ctx->bvh8_nodes + ((uint)next >> 3));
        at = ((const global uint *)(node + 192))[slot];
    }
}
#undef BVH8_NODE_REF

/* The world of a scene with instances is left together: a ray alone would hold up the others while it is in a mesh. */
#if BVH8_SINGLE && !(RT_SINGLE_RAY_MIXED && RT_HAS_INSTANCES)

/* The rays of `lanes` from `at` down, each on its own way but all by turns: while one waits, for memory as much as for arithmetic,
 * the others' work goes on, and what a turn does with a node is free of branches that depend on the ray. A turn looks for
 * candidates in all leaves that rays have come to, enters all nodes, tests the candidates, then sends on the rays that have met a
 * leaf, or that must pass over what lies beyond their nearest hit: eight entries at a time. A ray leaves a node for what is then
 * on top of its stack, a child or what was put off before. Children come in the order of their slots: ordering them by their
 * distances would save a node in thirty and cost more. Of a node's turn 80 instructions are left, each a hundredth of frames'
 * time by turns: so nodes and leaves are found alike, without a choice, and lists grow by their ends.
 *
 * Puts what was hit into `hit`, all of it as bvh8_single_ray_begin() found it or better. */
RT_INLINE void BVH8_INTERLEAVED(const rt_ctx *ctx, bvh8_single_ray *s, uint root, uint lanes, const rt_rays *ray, rt_hits *hit)
{
    const rt_single_rays *rays = &s->rays;
    float *const entry = s->entry;
    uint *const child = s->child, *const top = s->top;
    /* Lanes: at nodes and at leaves, now and next; in leaves with candidates; to be sent on. One more is written than counts. */
    uint nodes[2][RT_LANES + 1], leaves[2][RT_LANES + 1], tests[RT_LANES + 1], candidates[RT_LANES + 1], pops[RT_LANES + 1];
    uint code[RT_LANES];
    const global char *at[RT_LANES];
    const global char *const begin[2] = {(const global char *)ctx->bvh8_nodes, (const global char *)ctx->leaves};
    const ulong size[2] = {sizeof(bvh8_node), sizeof(rt_packed_prim)};
#define BVH8_GO_ON(l, to, alive)                                                                                                 \
    {                                                                                                                            \
        const uint is_leaf = (to) >> 31;                                                                                         \
        const global char *const next = begin[is_leaf] + BVH8_LEAF_FIRST(to) * size[is_leaf];                                    \
        bvh8_prefetch_at((ulong)next);                                                                                           \
        code[l] = to;                                                                                                            \
        at[l] = next;                                                                                                            \
        *node_end = l;                                                                                                           \
        node_end += (alive) & ~is_leaf;                                                                                          \
        *leaf_end = l;                                                                                                           \
        leaf_end += (alive)&is_leaf;                                                                                             \
    }
    uint *node_end = nodes[0], *leaf_end = leaves[0];
    for (uint bits = lanes; bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits);
        BVH8_GO_ON(l, root, 1u)
    }
    for (uint turn = 0;; ++turn) {
        const uint *const now_nodes_end = node_end, *const now_leaves_end = leaf_end;
        const uint *now_node = nodes[turn & 1u], *now_leaf = leaves[turn & 1u];
        if (now_node == now_nodes_end && now_leaf == now_leaves_end) break;
        uint test_count = 0, *pop_end = pops;
        node_end = nodes[~turn & 1u], leaf_end = leaves[~turn & 1u];
        for (; now_leaf != now_leaves_end; ++now_leaf) {
            const uint l = *now_leaf, first = BVH8_LEAF_FIRST(code[l]), count = BVH8_LEAF_COUNT(code[l]);
            RT_COUNT_LEAVES(hit, count);
            const uint bits = RT_SINGLE_RAY_CANDIDATES(ctx, first, count, rays, l);
            *pop_end++ = l;
            tests[test_count] = l;
            candidates[test_count] = bits;
            test_count += bits != 0u ? 1u : 0u;
        }
        for (; now_node != now_nodes_end; ++now_node) {
            RT_COUNT_VISIT(hit, 1u);
            const uint l = *now_node;
            const global char *const node = at[l];
            const float8 ix = (float8)(rays->ix[l]), iy = (float8)(rays->iy[l]), iz = (float8)(rays->iz[l]);
            const float8 ax = fma(ix, BVH8_ROW(node, (long)s->near_x[l]), (float8)(rays->near_x[l]));
            const float8 ay = fma(iy, BVH8_ROW(node, (long)s->near_y[l]), (float8)(rays->near_y[l]));
            const float8 az = fma(iz, BVH8_ROW(node, (long)s->near_z[l]), (float8)(rays->near_z[l]));
            const float8 bx = fma(ix, BVH8_ROW(node, (long)s->far_x[l]), (float8)(rays->far_x[l]));
            const float8 by = fma(iy, BVH8_ROW(node, (long)s->far_y[l]), (float8)(rays->far_y[l]));
            const float8 bz = fma(iz, BVH8_ROW(node, (long)s->far_z[l]), (float8)(rays->far_z[l]));
            const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(rays->t_min[l])));
            const float8 out = rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, (float8)(s->hits.t[l]));
            const uint base = top[l];
#if RT_ANY_HIT
            uint count = bvh8_push_any(in, out, node, child + base);
#else
            uint count = bvh8_push(in, out, node, s->slots + l, entry + base, child + base);
#endif
            if (!RT_STACK_OK(base + count - l * BVH8_ROOM, BVH8_BELOW + BVH8_STACK + 2u, hit)) count = 0;
            const uint last = base + count - 1u;
            top[l] = last;
#if RT_ANY_HIT
            BVH8_GO_ON(l, child[last], 1u)
#else
            const uint in_reach = entry[last] <= s->hits.t[l] ? 1u : 0u;
            BVH8_GO_ON(l, child[last], in_reach)
            *pop_end = l;
            pop_end += 1u - in_reach;
#endif
        }
        for (uint i = 0; i < test_count; ++i) {
            const uint l = tests[i];
            RT_SINGLE_RAY_TEST(ctx, BVH8_LEAF_FIRST(code[l]), candidates[i], rays, l, &s->hits, ray, hit);
        }
        for (const uint *pop = pops; pop != pop_end; ++pop) {
            const uint l = *pop;
#if RT_ANY_HIT
            const uint from = top[l] - 1u;
            const uint alive = (s->hits.t[l] >= 0.0f ? 1u : 0u) & (from >= l * BVH8_ROOM + BVH8_BELOW ? 1u : 0u);
#else
            const float8 t = (float8)(s->hits.t[l]);
            uint from = top[l] - 8u, open;
            while ((open = BVH8_BITS(vload8(0, entry + from) <= t)) == 0u) from -= 8u;
            from += 31u - (uint)clz(open);
            const uint alive = from >= l * BVH8_ROOM + BVH8_BELOW ? 1u : 0u;
#endif
            top[l] = from;
            BVH8_GO_ON(l, child[from], alive)
        }
    }
#undef BVH8_GO_ON
    rt_gather_hits(&s->hits, hit);
}

RT_INLINE void BVH8_INCOHERENT_PACKET(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    bvh8_single_ray lone;
    bvh8_single_ray_begin(&lone, ray, hit);
    BVH8_INTERLEAVED(ctx, &lone, root, rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))), ray, hit);
}

#else

RT_INLINE void BVH8_INCOHERENT_PACKET(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    uint top = 0;
    /* Near children go first by the signs of the direction, on which the lanes mostly agree: last onto the stack. */
    const uint far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u) | (ray->lo_z == 2u ? 4u : 0u);
    /* Of a box's two planes across an axis a ray meets one and then the other, whichever; each with the slack that it needs as the
     * near or the far one, which is widened as in a program of one lane. */
#define BVH8_AXIS(x)                                                                                                             \
    const vmask neg_##x = rt_negative(ray->i##x);                                                                                \
    const vfloat wide_##x = ray->i##x * RT_WIDE, off_##x = ray->far_##x * RT_WIDE;                                               \
    const vfloat i_lo_##x = rt_select(neg_##x, wide_##x, ray->i##x), o_lo_##x = rt_select(neg_##x, off_##x, ray->near_##x);       \
    const vfloat i_hi_##x = rt_select(neg_##x, ray->i##x, wide_##x), o_hi_##x = rt_select(neg_##x, ray->near_##x, off_##x);
    BVH8_AXIS(x)
    BVH8_AXIS(y)
    BVH8_AXIS(z)
#undef BVH8_AXIS
    vfloat stack_t[BVH8_STACK];
    uint stack_node[BVH8_STACK];
    uint inside = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); /* lanes in the node, for counting programs */
    for (;;) {
        if (at & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(at), count = BVH8_LEAF_COUNT(at);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, inside);
            const global bvh8_node *node = ctx->bvh8_nodes + at;
            vfloat entry[BVH8_WIDTH];
            uint found = 0;
            __attribute__((opencl_unroll_hint(BVH8_WIDTH)))
            for (uint i = 0; i < BVH8_WIDTH; ++i) {
                const uint slot = i ^ far_first;
                const vfloat lo_x = fma(i_lo_x, rt_vfloat(node->plane[0][slot]), o_lo_x), hi_x = fma(i_hi_x, rt_vfloat(node->plane[3][slot]), o_hi_x);
                const vfloat lo_y = fma(i_lo_y, rt_vfloat(node->plane[1][slot]), o_lo_y), hi_y = fma(i_hi_y, rt_vfloat(node->plane[4][slot]), o_hi_y);
                const vfloat lo_z = fma(i_lo_z, rt_vfloat(node->plane[2][slot]), o_lo_z), hi_z = fma(i_hi_z, rt_vfloat(node->plane[5][slot]), o_hi_z);
                entry[i] = rt_max(rt_max(rt_min(lo_x, hi_x), rt_min(lo_y, hi_y)), rt_max(rt_min(lo_z, hi_z), ray->t_min));
                const vfloat exit = rt_min(rt_min(rt_max(lo_x, hi_x), rt_max(lo_y, hi_y)), rt_min(rt_max(lo_z, hi_z), hit->t));
                const vmask in = RT_MASK(entry[i] <= exit);
                entry[i] = rt_select(in, entry[i], RT_INFINITY);
                found |= (rt_any(in) ? 1u : 0u) << i;
            }
            for (; found != 0u; found &= found - 1u) {
                const uint i = rt_lowest(found), child = node->child[i ^ far_first];
                bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, child);
                stack_node[top] = child;
                stack_t[top] = entry[i];
                if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;
            }
        }
        do {
            if (top == 0u) return;
            --top;
            inside = rt_bits(RT_MASK(stack_t[top] <= hit->t));
        } while (inside == 0u);
        at = stack_node[top];
    }
}

#endif


void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const vint octants = bvh8_octants(ray);
    const vfloat t = hit->t;
    uint rest = bvh8_which_octants(ray, octants, t);
    if (popcount(rest) > BVH8_SPLIT) {
        BVH8_INCOHERENT_PACKET(ctx, root, ray, hit);
        return;
    }
    for (; rest != 0u; rest &= rest - 1u) {
        const uint octant = rt_lowest(rest);
        const vmask mine = RT_MASK(octants == rt_vint((int)octant));
        const vfloat others = hit->t;
        hit->t = rt_select(mine, hit->t, rt_vfloat(-1.0f));
        BVH8_INTERVAL_PACKET(ctx, root, octant, ray, hit);
        hit->t = rt_select(mine, hit->t, others);
    }
}

#if RT_STREAM > 1
/* The packets `members` of a stream, two or more, whose active directions are all of one octant: the bounds of one packet in each lane. What
 * BVH8_INTERVAL_PACKET does with eight children at once is done here with as many packets, child by child, so that a node is fetched and
 * decided on once for all that come to it. */
RT_INLINE void BVH8_INTERVAL_STREAM(const rt_ctx *ctx, uint at, uint octant, const rt_rays *rays, rt_hits *hits, uint members)
{
    const ulong near_x = BVH8_NEAR(octant, 0), near_y = BVH8_NEAR(octant, 1), near_z = BVH8_NEAR(octant, 2);
    vmask alive[RT_LANES]; /* none in the place of a packet that is no member: a member's rays stand in for its own */
    const rt_rays *member[RT_LANES];
    vfloat each[RT_LANES], slow[3], fast[3], in[3], out[3];
    uint wide = 0;
    for (uint p = 0; p < RT_LANES; ++p) {
        const bool is_member = (members >> p & 1u) != 0u;
        const uint which = is_member ? p : rt_lowest(members);
        const vfloat t = rt_select(rt_vint(is_member ? -1 : 0), hits[which].t, rt_vfloat(-1.0f));
        member[p] = rays + which;
        alive[p] = RT_MASK(t >= rt_vfloat(0.0f));
        each[p] = t;
    }
    vfloat t_far = rt_greatest_each(each);
    /* ox, oy, oz lie side by side, and so do ix, iy, iz. */
#define BVH8_GREATEST(sign, field)                                                                                               \
    __attribute__((opencl_unroll_hint(RT_LANES)))                                                                                \
    for (uint p = 0; p < RT_LANES; ++p) each[p] = rt_select(alive[p], sign(&member[p]->field)[axis], rt_vfloat(-MAXFLOAT));
    for (uint axis = 0; axis < 3u; ++axis) {
        BVH8_GREATEST(, ox)
        const vfloat o_hi = rt_greatest_each(each);
        BVH8_GREATEST(-, ox)
        const vfloat o_lo = -rt_greatest_each(each);
        BVH8_GREATEST(, ix)
        const vfloat i_hi = rt_greatest_each(each);
        BVH8_GREATEST(-, ix)
        const vfloat i_lo = -rt_greatest_each(each);
        const bool turned = (octant >> axis & 1u) != 0u;
        wide |= rt_bits(RT_MASK(o_lo != o_hi) | RT_MASK(i_hi - i_lo > 0.25f * fabs(i_lo))); /* as BVH8_WIDE */
        slow[axis] = turned ? i_hi : i_lo;
        fast[axis] = turned ? i_lo : i_hi;
        in[axis] = BVH8_DOWN(-(turned ? o_lo : o_hi) * slow[axis]);
        out[axis] = BVH8_UP(-(turned ? o_hi : o_lo) * fast[axis]);
    }
#undef BVH8_GREATEST
    const vfloat slow_x = slow[0], slow_y = slow[1], slow_z = slow[2], fast_x = fast[0], fast_y = fast[1], fast_z = fast[2];
    const vfloat in_x = in[0], in_y = in[1], in_z = in[2], out_x = out[0], out_y = out[1], out_z = out[2];

    float few_t_far[RT_LANES], few[12][RT_LANES]; /* the same numbers, packet by packet */
    rt_store(t_far, few_t_far);
#define BVH8_STORE(x, i)                                                                                                         \
    rt_store(slow_##x, few[i]);                                                                                                  \
    rt_store(in_##x, few[(i) + 1]);                                                                                              \
    rt_store(fast_##x, few[(i) + 2]);                                                                                            \
    rt_store(out_##x, few[(i) + 3]);
    BVH8_STORE(x, 0)
    BVH8_STORE(y, 4)
    BVH8_STORE(z, 8)
#undef BVH8_STORE

    /* What is asked for when its parent is read is on its way for as long as a node takes, or several: a tree larger than the
     * caches kept waiting a third of the time that it was traced. */
    bvh8_stream_stack waiting;
    uint place = 0, inside = members;
    bool is_root = true;
#if RT_ANY_HIT
    /* Order is worth little, so there is a queue between the stack and its reader, nothing is sorted, and of who is done with a
     * packet one bit is enough. */
    uint searching = members, top = 0, coming[BVH8_AHEAD], coming_packets[BVH8_AHEAD], first_coming = 0, ahead = 0;
#else
    /* Nodes keep their order, but their leaves are tested after the next node: lists of now and of then. */
    uint top = BVH8_LISTS, list = 0, list_end = 0, fresh = BVH8_WIDTH, fresh_end = BVH8_WIDTH;
#endif
    for (;;) {
        const uint slot = place % BVH8_WIDTH;
        const global char *node = (const global char *)(ctx->bvh8_nodes + place / BVH8_WIDTH);
        if (!is_root) at = ((const global uint *)(node + 192))[slot];
        if (at & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(at), count = BVH8_LEAF_COUNT(at);
            /* Who enters, then which triangles they may hit, then those: a branch on each would be guessed wrongly every other time. */
            uint entering = 0, count_candidates = 0;
            for (; inside != 0u; inside &= inside - 1u) {
                const uint p = rt_lowest(inside);
                entering |= (BVH8_ENTER(node + 4u * slot, near_x, near_y, near_z, rays + p, hits + p) != 0u ? 1u : 0u) << p;
            }
            uint candidates[RT_STREAM * BVH8_LEAF_MAX + 1u];
            for (; entering != 0u; entering &= entering - 1u) {
                const uint p = rt_lowest(entering);
                for (uint i = 0; i < count; ++i) {
                    candidates[count_candidates] = p * 8u + i;
                    count_candidates += RT_LEAF_CANDIDATE(ctx, first + i, rays + p, hits + p);
                }
            }
            for (uint i = 0; i < count_candidates; ++i) {
                const uint p = candidates[i] / 8u;
                RT_LEAF_TEST(ctx, first + candidates[i] % 8u, rays + p, hits + p);
#if RT_ANY_HIT
                searching &= ~((rt_any(RT_MASK(hits[p].t >= rt_vfloat(0.0f))) ? 0u : 1u) << p);
#else
                few_t_far[p] = rt_greatest(hits[p].t);
                t_far = rt_select(RT_MASK(rt_lane_index() == rt_vint((int)p)), rt_vfloat(few_t_far[p]), t_far);
#endif
            }
        } else {
            for (uint doubt = is_root ? 0u : inside & wide; doubt != 0u; doubt &= doubt - 1u) {
                const uint p = rt_lowest(doubt);
                if (BVH8_ENTER(node + 4u * slot, near_x, near_y, near_z, rays + p, hits + p) == 0u) inside &= ~(1u << p);
            }
            is_root = false;
            BVH8_COUNT_VISITS(hits, inside)
            node = (const global char *)(ctx->bvh8_nodes + at);
            vfloat entry[BVH8_WIDTH];
            uint enters[BVH8_WIDTH], found = 0;
            if (popcount(inside) == 1u) { /* one packet is left: all children at once */
                const uint p = rt_lowest(inside);
#define BVH8_FEW(i) ((float8)(few[i][p]))
                const float8 ax = fma(BVH8_FEW(0), BVH8_ROW(node, near_x), BVH8_FEW(1));
                const float8 bx = fma(BVH8_FEW(2), BVH8_ROW(node, 96u - near_x), BVH8_FEW(3));
                const float8 ay = fma(BVH8_FEW(4), BVH8_ROW(node, near_y), BVH8_FEW(5));
                const float8 by = fma(BVH8_FEW(6), BVH8_ROW(node, 160u - near_y), BVH8_FEW(7));
                const float8 az = fma(BVH8_FEW(8), BVH8_ROW(node, near_z), BVH8_FEW(9));
                const float8 bz = fma(BVH8_FEW(10), BVH8_ROW(node, 224u - near_z), BVH8_FEW(11));
#undef BVH8_FEW
                const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(0.0f)));
                found = BVH8_BITS(in <= rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, (float8)(few_t_far[p])));
#if RT_ANY_HIT
                for (uint rest = found; rest != 0u; rest &= rest - 1u) enters[rt_lowest(rest)] = inside;
#else
                float ins[BVH8_WIDTH];
                vstore8(in, 0, ins);
                for (uint rest = found; rest != 0u; rest &= rest - 1u) {
                    const uint i = rt_lowest(rest);
                    ((float *)(entry + i))[p] = ins[i];
                    enters[i] = inside;
                }
#endif
            } else {
                __attribute__((opencl_unroll_hint(BVH8_WIDTH)))
                for (uint i = 0; i < BVH8_WIDTH; ++i) {
                    const global char *box = node + 4u * i;
                    const vfloat ax = fma(slow_x, BVH8_PLANE(box, near_x), in_x), bx = fma(fast_x, BVH8_PLANE(box, 96u - near_x), out_x);
                    const vfloat ay = fma(slow_y, BVH8_PLANE(box, near_y), in_y), by = fma(fast_y, BVH8_PLANE(box, 160u - near_y), out_y);
                    const vfloat az = fma(slow_z, BVH8_PLANE(box, near_z), in_z), bz = fma(fast_z, BVH8_PLANE(box, 224u - near_z), out_z);
                    entry[i] = rt_max(rt_max(ax, ay), rt_max(az, rt_vfloat(0.0f)));
                    enters[i] = inside & rt_bits(RT_MASK(entry[i] <= rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, t_far)));
                    found |= (enters[i] != 0u ? 1u : 0u) << i;
                }
            }
#if RT_ANY_HIT
            for (; found != 0u; found &= found - 1u) {
                const uint i = rt_lowest(found);
                bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, ctx->bvh8_nodes[at].child[i]);
                waiting.place[top] = at * BVH8_WIDTH + i;
                waiting.packets[top] = enters[i];
                if (RT_STACK_OK(top + 1u, BVH8_STREAM_STACK + 1u, hits)) ++top;
            }
#else
#define BVH8_PUSH_DEFERRED(to, some) bvh8_push_deferred(&waiting, to, ctx->bvh8_nodes, ctx->leaves, at, some, entry, enters, rt_lowest(inside))
            const uint leaves = found & BVH8_BITS(*(const global int8 *)(node + 192) < (int8)(0)); /* BVH8_LEAF */
            const uint stacked = found ^ leaves;
            if (leaves != 0u) fresh_end = BVH8_PUSH_DEFERRED(fresh, leaves);
            if (stacked != 0u) {
                const uint end = BVH8_PUSH_DEFERRED(top, stacked);
                if (RT_STACK_OK(end, BVH8_STREAM_STACK + 1u, hits)) top = end;
            }
#undef BVH8_PUSH_DEFERRED
#endif
        }

#if RT_ANY_HIT
        while (ahead < (top < BVH8_STACK ? BVH8_AHEAD : 1u) && top > 0u) {
            --top;
            const uint last = (first_coming + ahead) % BVH8_AHEAD;
            coming[last] = waiting.place[top];
            coming_packets[last] = waiting.packets[top] & searching;
            ahead += coming_packets[last] != 0u ? 1u : 0u;
        }
        if (ahead == 0u) return;
        place = coming[first_coming], inside = coming_packets[first_coming];
        first_coming = (first_coming + 1u) % BVH8_AHEAD, --ahead;
#else
        for (inside = 0; inside == 0u;) {
            if (list_end > list) {
                --list_end;
                place = waiting.place[list_end], inside = BVH8_STILL(list_end);
                continue;
            }
            const uint done = list;
            list = fresh, list_end = fresh_end, fresh = fresh_end = done;
            while (inside == 0u && top > BVH8_LISTS) {
                --top;
                place = waiting.place[top], inside = BVH8_STILL(top);
            }
            if (inside == 0u && list_end == list) return;
        }
#endif
    }
}

void RT_TRAVERSE_STREAM(const rt_ctx *ctx, uint root, const rt_rays *rays, rt_hits *hits, uint count)
{
    uint with[8] = {0, 0, 0, 0, 0, 0, 0, 0}, apart = 0, mixed = 0;
    for (uint p = 0; p < count; ++p) {
        uint rest = bvh8_which_octants(rays + p, bvh8_octants(rays + p), hits[p].t);
        if (popcount(rest) > BVH8_SPLIT || BVH8_INCOHERENT(rays + p, rest)) {
            apart |= 1u << p;
            continue;
        }
        mixed |= (popcount(rest) > 1u ? 1u : 0u) << p;
        for (; rest != 0u; rest &= rest - 1u) with[rt_lowest(rest)] |= 1u << p;
    }
    for (; apart != 0u; apart &= apart - 1u) BVH8_INCOHERENT_PACKET(ctx, root, rays + rt_lowest(apart), hits + rt_lowest(apart));
    for (uint octant = 0; octant < 8u; ++octant) {
        const uint members = with[octant];
        if (members == 0u) continue;
        vfloat others[RT_STREAM];
        for (uint some = members & mixed; some != 0u; some &= some - 1u) {
            const uint p = rt_lowest(some);
            others[p] = hits[p].t;
            hits[p].t = rt_select(RT_MASK(bvh8_octants(rays + p) == rt_vint((int)octant)), hits[p].t, rt_vfloat(-1.0f));
        }
        if (popcount(members) > 1u)
            BVH8_INTERVAL_STREAM(ctx, root, octant, rays, hits, members);
        else
            BVH8_INTERVAL_PACKET(ctx, root, octant, rays + rt_lowest(members), hits + rt_lowest(members));
        for (uint some = members & mixed; some != 0u; some &= some - 1u) {
            const uint p = rt_lowest(some);
            hits[p].t = rt_select(RT_MASK(bvh8_octants(rays + p) == rt_vint((int)octant)), hits[p].t, others[p]);
        }
    }
}
#endif

#endif
