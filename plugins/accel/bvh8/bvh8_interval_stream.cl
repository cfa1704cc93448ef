/* bvh8_interval_stream.cl -- two or more packets of a stream with active rays all of one octant: the interval of one packet in
 * each lane, against one child after the other.
 *
 * bvh8_interval_packet.cl tests eight children at once, this file as many packets. A node is fetched and decided on once for
 * all packets that come to it, a fifth to a tenth as often. `members` are the packets' bits. */
RT_INLINE void BVH8_INTERVAL_STREAM(const rt_ctx *ctx, uint ref, uint octant, const rt_rays *rays, rt_hits *hits, uint members)
{
    const bvh8_rows rows = bvh8_octant_rows(octant);
    vmask active[RT_LANES]; /* none for a packet that is no member: the rays of a member stand in for its own */
    const rt_rays *member[RT_LANES];
    vfloat each[RT_LANES], near_slope[3], far_slope[3], near_offset[3], far_offset[3];
    uint wide = 0; /* packets */
    for (uint p = 0; p < RT_LANES; ++p) {
        const bool is_member = (members >> p & 1u) != 0u;
        const uint which = is_member ? p : rt_lowest(members);
        const vfloat t = rt_select(rt_vint(is_member ? -1 : 0), hits[which].t, rt_vfloat(-1.0f));
        member[p] = rays + which;
        active[p] = bvh8_bounded(member[p], t);
        each[p] = t;
    }
    vfloat t_far = rt_greatest_each(each);
    /* ox, oy, oz lie side by side, and so do ix, iy, iz. */
#define BVH8_GREATEST(sign, field)                                                                                             \
    __attribute__((opencl_unroll_hint(RT_LANES)))                                                                              \
    for (uint p = 0; p < RT_LANES; ++p) each[p] = rt_select(active[p], sign(&member[p]->field)[axis], rt_vfloat(-MAXFLOAT));
    for (uint axis = 0; axis < 3u; ++axis) {
        BVH8_GREATEST(, ox)
        const vfloat o_hi = rt_greatest_each(each);
        BVH8_GREATEST(-, ox)
        const vfloat o_lo = -rt_greatest_each(each);
        BVH8_GREATEST(, ix)
        const vfloat i_hi = rt_greatest_each(each);
        BVH8_GREATEST(-, ix)
        const vfloat i_lo = -rt_greatest_each(each);
        const bool negative = (octant >> axis & 1u) != 0u;
        wide |= rt_bits(BVH8_IS_WIDE(o_lo, o_hi, i_lo, i_hi));
        near_slope[axis] = negative ? i_hi : i_lo;
        far_slope[axis] = negative ? i_lo : i_hi;
        near_offset[axis] = BVH8_NEAR_OFFSET(negative ? o_lo : o_hi, near_slope[axis]);
        far_offset[axis] = BVH8_FAR_OFFSET(negative ? o_hi : o_lo, far_slope[axis]);
    }
#undef BVH8_GREATEST
    const vfloat near_slope_x = near_slope[0], near_slope_y = near_slope[1], near_slope_z = near_slope[2];
    const vfloat near_offset_x = near_offset[0], near_offset_y = near_offset[1], near_offset_z = near_offset[2];
    const vfloat far_slope_x = far_slope[0], far_slope_y = far_slope[1], far_slope_z = far_slope[2];
    const vfloat far_offset_x = far_offset[0], far_offset_y = far_offset[1], far_offset_z = far_offset[2];

    /* The same numbers packet by packet, for a packet that comes to a node alone. */
    float packet_t_far[RT_LANES], packet_slab[12][RT_LANES];
    rt_store(t_far, packet_t_far);
#define BVH8_STORE(x, i)                                                                                                       \
    rt_store(near_slope_##x, packet_slab[i]);                                                                                  \
    rt_store(near_offset_##x, packet_slab[(i) + 1]);                                                                           \
    rt_store(far_slope_##x, packet_slab[(i) + 2]);                                                                             \
    rt_store(far_offset_##x, packet_slab[(i) + 3]);
    BVH8_STORE(x, 0)
    BVH8_STORE(y, 4)
    BVH8_STORE(z, 8)
#undef BVH8_STORE

    /* A child is prefetched when its parent is read, so that it arrives while one node or several are tested. Without that,
     * packets waited a third of the time that they took in a tree larger than the caches. */
    bvh8_stream_stack stack;
    uint node_slot = 0, inside = members; /* the entry that is visited, and the packets in it */
    bool is_root = true;
#if RT_ANY_HIT
    /* Order matters little. So nothing is sorted, a queue between the stack and its reader gives prefetches time, and one bit
     * tells which packets still search. */
    uint searching = members, top = 0, queue[BVH8_QUEUE_SIZE], queue_packets[BVH8_QUEUE_SIZE], queue_first = 0, queued = 0;
#else
    /* Nodes keep their order, but leaves are tested after the next node: a list of leaves to test now, and one to test then. */
    uint top = BVH8_LEAF_LISTS, list = 0, list_end = 0, next_list = BVH8_WIDTH, next_list_end = BVH8_WIDTH;
#endif
    for (;;) {
        const uint slot = node_slot % BVH8_WIDTH;
        const global char *node = (const global char *)(ctx->bvh8_nodes + node_slot / BVH8_WIDTH);
        if (!is_root) ref = BVH8_CHILDREN(node)[slot];
        if (ref & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(ref), count = BVH8_LEAF_COUNT(ref);
            /* First which packets enter, then which triangles each may hit, then these triangles. A branch for each of these
             * questions would be predicted wrongly every other time. */
            uint entering = 0, candidate_count = 0;
            for (; inside != 0u; inside &= inside - 1u) {
                const uint p = rt_lowest(inside);
                entering |= (bvh8_enter_child(node + 4u * slot, &rows, rays + p, hits + p) != 0u ? 1u : 0u) << p;
            }
            uint candidates[RT_STREAM * BVH8_LEAF_MAX + 1u]; /* packet * 8 + primitive of the leaf */
            for (; entering != 0u; entering &= entering - 1u) {
                const uint p = rt_lowest(entering);
                for (uint i = 0; i < count; ++i) {
                    candidates[candidate_count] = p * 8u + i;
                    candidate_count += RT_LEAF_CANDIDATE(ctx, first + i, rays + p, hits + p);
                }
            }
            for (uint i = 0; i < candidate_count; ++i) {
                const uint p = candidates[i] / 8u;
                RT_LEAF_TEST(ctx, first + candidates[i] % 8u, rays + p, hits + p);
#if RT_ANY_HIT
                searching &= ~((rt_any(RT_MASK(hits[p].t >= rt_vfloat(0.0f))) ? 0u : 1u) << p);
#else
                packet_t_far[p] = rt_greatest(hits[p].t);
                t_far = rt_select(RT_MASK(rt_lane_index() == rt_vint((int)p)), rt_vfloat(packet_t_far[p]), t_far);
#endif
            }
        } else {
            for (uint untested = is_root ? 0u : inside & wide; untested != 0u; untested &= untested - 1u) {
                const uint p = rt_lowest(untested);
                if (bvh8_enter_child(node + 4u * slot, &rows, rays + p, hits + p) == 0u) inside &= ~(1u << p);
            }
            is_root = false;
            BVH8_COUNT_VISITS(rays, hits, inside)
            node = (const global char *)(ctx->bvh8_nodes + ref);
            vfloat entry[BVH8_WIDTH];
            uint packets[BVH8_WIDTH], entered = 0; /* packets that enter each child; children that any packet enters */
            if (popcount(inside) == 1u) {          /* one packet is left: all children at once */
                const uint p = rt_lowest(inside);
                const bvh8_slab_ray slab = {packet_slab[0][p], packet_slab[4][p], packet_slab[8][p],  packet_slab[1][p],
                                            packet_slab[5][p], packet_slab[9][p], packet_slab[2][p],  packet_slab[6][p],
                                            packet_slab[10][p], packet_slab[3][p], packet_slab[7][p], packet_slab[11][p]};
                float8 in, out;
                bvh8_intersect(node, &rows, &slab, 0.0f, packet_t_far[p], &in, &out);
                entered = BVH8_BITS(in <= out);
#if RT_ANY_HIT
                for (uint rest = entered; rest != 0u; rest &= rest - 1u) packets[rt_lowest(rest)] = inside;
#else
                float distance[BVH8_WIDTH];
                vstore8(in, 0, distance);
                for (uint rest = entered; rest != 0u; rest &= rest - 1u) {
                    const uint i = rt_lowest(rest);
                    ((float *)(entry + i))[p] = distance[i];
                    packets[i] = inside;
                }
#endif
            } else {
                __attribute__((opencl_unroll_hint(BVH8_WIDTH)))
                for (uint i = 0; i < BVH8_WIDTH; ++i) {
                    const global char *box = node + 4u * i;
                    const vfloat ax = fma(near_slope_x, BVH8_PLANE(box, rows.near_x), near_offset_x),
                                 bx = fma(far_slope_x, BVH8_PLANE(box, rows.far_x), far_offset_x);
                    const vfloat ay = fma(near_slope_y, BVH8_PLANE(box, rows.near_y), near_offset_y),
                                 by = fma(far_slope_y, BVH8_PLANE(box, rows.far_y), far_offset_y);
                    const vfloat az = fma(near_slope_z, BVH8_PLANE(box, rows.near_z), near_offset_z),
                                 bz = fma(far_slope_z, BVH8_PLANE(box, rows.far_z), far_offset_z);
                    vfloat out;
                    rt_intersect_slabs(ax, ay, az, bx, by, bz, rt_vfloat(0.0f), t_far, entry + i, &out);
                    packets[i] = inside & rt_bits(RT_MASK(entry[i] <= out));
                    entered |= (packets[i] != 0u ? 1u : 0u) << i;
                }
            }
#if RT_ANY_HIT
            for (; entered != 0u; entered &= entered - 1u) {
                const uint i = rt_lowest(entered);
                bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, ctx->bvh8_nodes[ref].child[i]);
                stack.slot[top] = ref * BVH8_WIDTH + i;
                stack.packets[top] = packets[i];
                if (RT_STACK_OK(top + 1u, BVH8_STREAM_STACK + 1u, hits)) ++top;
            }
#else
            const uint leaves = entered & BVH8_BITS(*(const global int8 *)(node + 192) < (int8)(0)); /* BVH8_LEAF */
            const uint nodes = entered ^ leaves, guide = rt_lowest(inside);
            if (leaves != 0u)
                next_list_end =
                    bvh8_push_deferred(&stack, next_list, ctx->bvh8_nodes, ctx->leaves, ref, leaves, entry, packets, guide);
            if (nodes != 0u) {
                const uint end = bvh8_push_deferred(&stack, top, ctx->bvh8_nodes, ctx->leaves, ref, nodes, entry, packets, guide);
                if (RT_STACK_OK(end, BVH8_STREAM_STACK + 1u, hits)) top = end;
            }
#endif
        }

#if RT_ANY_HIT
        while (queued < (top < BVH8_STACK ? BVH8_QUEUE_SIZE : 1u) && top > 0u) {
            --top;
            const uint last = (queue_first + queued) % BVH8_QUEUE_SIZE;
            queue[last] = stack.slot[top];
            queue_packets[last] = stack.packets[top] & searching;
            queued += queue_packets[last] != 0u ? 1u : 0u;
        }
        if (queued == 0u) return;
        node_slot = queue[queue_first], inside = queue_packets[queue_first];
        queue_first = (queue_first + 1u) % BVH8_QUEUE_SIZE, --queued;
#else
        for (inside = 0; inside == 0u;) {
            if (list_end > list) {
                --list_end;
                node_slot = stack.slot[list_end], inside = bvh8_remaining(&stack, list_end, t_far);
                continue;
            }
            const uint tested_list = list;
            list = next_list, list_end = next_list_end, next_list = next_list_end = tested_list;
            while (inside == 0u && top > BVH8_LEAF_LISTS) {
                --top;
                node_slot = stack.slot[top], inside = bvh8_remaining(&stack, top, t_far);
            }
            if (inside == 0u && list_end == list) return;
        }
#endif
    }
}
