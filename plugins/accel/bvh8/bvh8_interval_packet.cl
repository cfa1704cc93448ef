/* bvh8_interval_packet.cl -- one packet with directions of one octant: the interval of its rays against all eight children of a
 * node at once.
 *
 * Reshetov, Soupikov, Hurley 2005, "Multi-Level Ray Tracing Algorithm". Before a leaf the rays themselves are tested against
 * its box, and before a node too where the interval is wide. */
RT_INLINE void BVH8_INTERVAL_PACKET(const rt_ctx *ctx, uint ref, uint octant, const rt_rays *ray, rt_hits *hit)
{
    const vmask active = bvh8_bounded(ray, hit->t);
    float t_far = rt_greatest(hit->t);
    const bvh8_rows rows = bvh8_octant_rows(octant);
    /* A ray meets the plane p at (p - origin) / direction. No ray meets a near plane ahead of it earlier than the slowest ray
     * from the foremost origin would, and none leaves by a far plane later than the fastest ray from the hindmost origin. For
     * planes behind the origin both are negative, t_min is not, and 0 stands for it. Each is computed as fma(1 / direction, p,
     * -origin / direction), with the slack of rt_prepare_for_boxes(). */
    bvh8_slab_ray slab;
    bool wide = false;
#define BVH8_AXIS(x, negative)                                                                                                 \
    const float o_lo_##x = rt_least_of(active, ray->o##x), o_hi_##x = rt_greatest_of(active, ray->o##x);                       \
    const float i_lo_##x = rt_least_of(active, ray->i##x), i_hi_##x = rt_greatest_of(active, ray->i##x);                       \
    slab.near_slope_##x = (negative) ? i_hi_##x : i_lo_##x, slab.far_slope_##x = (negative) ? i_lo_##x : i_hi_##x;             \
    slab.near_offset_##x = BVH8_NEAR_OFFSET((negative) ? o_lo_##x : o_hi_##x, slab.near_slope_##x);                               \
    slab.far_offset_##x = BVH8_FAR_OFFSET((negative) ? o_hi_##x : o_lo_##x, slab.far_slope_##x);                                   \
    wide |= BVH8_IS_WIDE(o_lo_##x, o_hi_##x, i_lo_##x, i_hi_##x) != 0;
    BVH8_AXIS(x, (octant & 1u) != 0u)
    BVH8_AXIS(y, (octant & 2u) != 0u)
    BVH8_AXIS(z, (octant & 4u) != 0u)
#undef BVH8_AXIS

    /* Entries: entry distance in the upper half, node * 8 + slot in the lower. From the slot a leaf's box is found again. */
    ulong stack[BVH8_STACK];
    const global char *node = (const global char *)(ctx->bvh8_nodes + ref);
    uint top = 0, slot = 0;
    bool is_entered = true; /* whether a ray is known to enter `ref` */
    for (;;) {
        if (ref & BVH8_LEAF) {
            if (bvh8_enter_child(node + 4u * slot, &rows, ray, hit) != 0u) {
                const uint first = BVH8_LEAF_FIRST(ref), count = BVH8_LEAF_COUNT(ref);
                for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
                t_far = rt_greatest(hit->t);
#if RT_ANY_HIT
                if (t_far < 0.0f) return;
#endif
            }
        } else if (!wide || is_entered || bvh8_enter_child(node + 4u * slot, &rows, ray, hit) != 0u) {
            is_entered = false;
            RT_COUNT_STEP(hit);
            RT_COUNT_BOXES(hit, BVH8_WIDTH);
            node = (const global char *)RT_NODE(ray, ctx->bvh8_nodes + ref);
            float8 in, out;
            bvh8_intersect(node, &rows, &slab, 0.0f, t_far, &in, &out);
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                const global uint *child = BVH8_CHILDREN(node);
                slot = rt_lowest(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    ref = child[slot];
                    continue;
                }
                float distance[BVH8_WIDTH];
                vstore8(in, 0, distance);
                bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, child[slot]);
                ulong nearest = BVH8_ENTRY(distance[slot], ref * 8u + slot);
                for (; bits != 0u; bits &= bits - 1u) {
                    const uint i = rt_lowest(bits);
                    bvh8_prefetch(ctx->bvh8_nodes, ctx->leaves, child[i]);
                    const ulong entry = BVH8_ENTRY(distance[i], ref * 8u + i);
                    stack[top] = max(entry, nearest);
                    nearest = min(entry, nearest);
                    if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;
                }
                slot = (uint)nearest & 7u;
                ref = child[slot];
                continue;
            }
        }
        ulong next;
        do {
            if (top == 0u) return;
            next = stack[--top];
        } while (BVH8_ENTRY_T(next) > t_far);
        slot = (uint)next & 7u;
        node = (const global char *)(ctx->bvh8_nodes + ((uint)next >> 3));
        ref = BVH8_CHILDREN(node)[slot];
    }
}
