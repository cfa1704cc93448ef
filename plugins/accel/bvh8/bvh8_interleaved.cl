/* bvh8_interleaved.cl -- the rays of an incoherent packet, each on its own way with a stack of its own, one step of each in
 * turn.
 *
 * While one ray waits for memory or arithmetic, the others' work goes on, and a step through a node has no branch that depends
 * on the ray. A round makes a step for each ray: it looks for candidates in all leaves that rays have come to; intersects all
 * nodes; tests the candidates; then pops, eight entries at a time, for the rays that have tested a leaf or must skip children
 * beyond their nearest hits. A ray leaves a node for the entry on top of its stack, a child or one that was deferred before.
 *
 * Children are pushed in the order of their slots: ordering them by their distances would save a node in thirty and cost more.
 * A step through a node takes 80 instructions, and each of these is a hundredth of the time of a frame that is traced in this
 * way. So nodes and leaves are addressed alike, without a branch, and lists are written before it is known whether they grow.
 *
 * `lanes`: the rays to trace from `root`. Puts the rays' hits into `hit`, all of it as bvh8_begin_ray_stacks() found it or
 * nearer. */
RT_INLINE void BVH8_INTERLEAVED(const rt_ctx *ctx, bvh8_ray_stacks *s, uint root, uint lanes, const rt_rays *ray, rt_hits *hit)
{
    const rt_single_rays *rays = &s->rays;
    float *const entry = s->entry;
    uint *const child = s->child, *const top = s->top;
    /* Lists of lanes: at nodes and at leaves, in this round and the next; in leaves with candidates; to be popped. One more is
     * written than counts. */
    uint nodes[2][RT_LANES + 1], leaves[2][RT_LANES + 1], tests[RT_LANES + 1], candidates[RT_LANES + 1], pops[RT_LANES + 1];
    uint ref[RT_LANES];
    const global char *address[RT_LANES]; /* of each lane's node or leaf */
    const global char *const begin[2] = {(const global char *)ctx->bvh8_nodes, (const global char *)ctx->leaves};
    const ulong size[2] = {sizeof(bvh8_node), sizeof(rt_packed_prim)};
    /* Sends lane l to a node or leaf. active: 1, or 0 if its ray is done. */
#define BVH8_VISIT_NEXT(l, to, active)                                                                                         \
    {                                                                                                                          \
        const uint is_leaf = (to) >> 31;                                                                                       \
        const global char *const next = begin[is_leaf] + BVH8_LEAF_FIRST(to) * size[is_leaf];                                  \
        bvh8_prefetch_at((ulong)next);                                                                                         \
        ref[l] = to;                                                                                                           \
        address[l] = next;                                                                                                     \
        *node_end = l;                                                                                                           \
        node_end += (active) & ~is_leaf;                                                                                       \
        *leaf_end = l;                                                                                                           \
        leaf_end += (active)&is_leaf;                                                                                          \
    }
    uint *node_end = nodes[0], *leaf_end = leaves[0];
    for (uint bits = lanes; bits != 0u; bits &= bits - 1u) {
        const uint l = rt_lowest(bits);
        BVH8_VISIT_NEXT(l, root, 1u)
    }
    for (uint iteration = 0;; ++iteration) {
        const uint *const current_nodes_end = node_end, *const current_leaves_end = leaf_end;
        const uint *current_node = nodes[iteration & 1u], *current_leaf = leaves[iteration & 1u];
        if (current_node == current_nodes_end && current_leaf == current_leaves_end) break;
        uint test_count = 0, *pop_end = pops;
        node_end = nodes[~iteration & 1u], leaf_end = leaves[~iteration & 1u];
        for (; current_leaf != current_leaves_end; ++current_leaf) {
            const uint l = *current_leaf, first = BVH8_LEAF_FIRST(ref[l]), count = BVH8_LEAF_COUNT(ref[l]);
            const uint bits = RT_SINGLE_RAY_CANDIDATES(ctx, first, count, rays, l);
            *pop_end++ = l;
            tests[test_count] = l;
            candidates[test_count] = bits;
            test_count += bits != 0u ? 1u : 0u;
        }
        for (; current_node != current_nodes_end; ++current_node) {
            RT_COUNT_VISIT(hit, 1u);
            RT_COUNT_BOXES(hit, BVH8_WIDTH);
            const uint l = *current_node;
            const global char *const node = RT_NODE(ray, address[l]);
            const bvh8_rows rows = {(long)s->near_x[l], (long)s->near_y[l], (long)s->near_z[l],
                                    (long)s->far_x[l],  (long)s->far_y[l],  (long)s->far_z[l]};
            const bvh8_slab_ray slab = {rays->ix[l],     rays->iy[l],     rays->iz[l], rays->near_x[l], rays->near_y[l], rays->near_z[l],
                                        rays->ix[l],     rays->iy[l],     rays->iz[l], rays->far_x[l],  rays->far_y[l],  rays->far_z[l]};
            float8 in, out;
            bvh8_intersect(node, &rows, &slab, rays->t_min[l], s->hits.t[l], &in, &out);
            const uint base = top[l];
#if RT_ANY_HIT
            uint count = bvh8_push_any(in, out, node, child + base);
#else
            uint count = bvh8_push(in, out, node, s->slots + l, entry + base, child + base);
#endif
            if (!RT_STACK_OK(base + count - l * BVH8_RAY_STACK, BVH8_SENTINELS + BVH8_STACK + 2u, hit)) count = 0;
            const uint last = base + count - 1u;
            top[l] = last;
#if RT_ANY_HIT
            BVH8_VISIT_NEXT(l, child[last], 1u)
#else
            const uint in_reach = entry[last] <= s->hits.t[l] ? 1u : 0u;
            BVH8_VISIT_NEXT(l, child[last], in_reach)
            *pop_end = l;
            pop_end += 1u - in_reach;
#endif
        }
        for (uint i = 0; i < test_count; ++i) {
            const uint l = tests[i];
            RT_SINGLE_RAY_TEST(ctx, BVH8_LEAF_FIRST(ref[l]), candidates[i], rays, l, &s->hits, ray, hit);
        }
        for (const uint *pop = pops; pop != pop_end; ++pop) {
            const uint l = *pop;
#if RT_ANY_HIT
            const uint from = top[l] - 1u;
            const uint active = (s->hits.t[l] >= 0.0f ? 1u : 0u) & (from >= l * BVH8_RAY_STACK + BVH8_SENTINELS ? 1u : 0u);
#else
            const float8 t = (float8)(s->hits.t[l]);
            uint from = top[l] - 8u, in_reach;
            while ((in_reach = BVH8_BITS(vload8(0, entry + from) <= t)) == 0u) from -= 8u;
            from += 31u - (uint)clz(in_reach);
            const uint active = from >= l * BVH8_RAY_STACK + BVH8_SENTINELS ? 1u : 0u;
#endif
            top[l] = from;
            BVH8_VISIT_NEXT(l, child[from], active)
        }
    }
#undef BVH8_VISIT_NEXT
    rt_gather_hits(&s->hits, hit);
}
