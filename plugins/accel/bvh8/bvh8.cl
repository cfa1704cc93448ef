/* bvh8.cl -- one ray against eight boxes at once (RT_LANES 1), or a packet of rays against one box after the other.
 *
 * A single ray takes the nearest child and puts the others off in the order of their distances. Most nodes leave one or two
 * children, and branching on their number costs less than sorting vectors of eight: a network in registers took a tenth longer,
 * and so did putting all off in the order of the slots by compressing stores. Where any hit will do, order is worth nothing:
 * nearly as few nodes are visited without it, each for less. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    uint top = 0, at = root;
#if RT_LANES == 1
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
            RT_LONE_LEAVES(ctx, first, count, ray, 0u, hit, ray, hit);
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
                at = child[BVH8_LOWEST(bits)];
                for (bits &= bits - 1u; bits != 0u; bits &= bits - 1u) BVH8_PUSH(child[BVH8_LOWEST(bits)])
                continue;
#else
                uint i = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    at = child[i];
                    continue;
                }
                float entry[BVH8_WIDTH];
                vstore8(in, 0, entry);
                ulong key = BVH8_KEY(entry, child, i);
                i = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                ulong other = BVH8_KEY(entry, child, i);
                ulong nearest = min(key, other), second = max(key, other);
                if (bits != 0u) {
                    i = BVH8_LOWEST(bits);
                    bits &= bits - 1u;
                    key = BVH8_KEY(entry, child, i);
                    other = min(key, second);
                    const uint base = top;
                    BVH8_PUSH(max(key, second))
                    second = max(other, nearest);
                    nearest = min(other, nearest);
                    for (; bits != 0u; bits &= bits - 1u) {
                        /* The farther ones go where they belong: between `base` and the top the farthest is lowest. */
                        key = BVH8_KEY(entry, child, BVH8_LOWEST(bits));
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
#else
    /* Near children go first by the signs of the direction, on which the lanes mostly agree: last onto the stack. */
    const uint far_first = (ray->lo_x == 0u ? 1u : 0u) | (ray->lo_y == 1u ? 2u : 0u) | (ray->lo_z == 2u ? 4u : 0u);
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
            for (uint i = 0; i < BVH8_WIDTH; ++i) {
                const uint slot = i ^ far_first, child = node->child[slot];
                if (child == BVH8_NOTHING) continue;
                vfloat entry;
                vmask in;
                if (ray->coherent) {
                    const vfloat ax = fma(ray->ix, rt_vfloat(node->plane[ray->lo_x][slot]), ray->near_x);
                    const vfloat ay = fma(ray->iy, rt_vfloat(node->plane[ray->lo_y][slot]), ray->near_y);
                    const vfloat az = fma(ray->iz, rt_vfloat(node->plane[ray->lo_z][slot]), ray->near_z);
                    const vfloat bx = fma(ray->ix, rt_vfloat(node->plane[3u - ray->lo_x][slot]), ray->far_x);
                    const vfloat by = fma(ray->iy, rt_vfloat(node->plane[5u - ray->lo_y][slot]), ray->far_y);
                    const vfloat bz = fma(ray->iz, rt_vfloat(node->plane[7u - ray->lo_z][slot]), ray->far_z);
                    entry = rt_max(rt_max(ax, ay), rt_max(az, ray->t_min));
                    in = RT_MASK(entry <= rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, hit->t));
                } else {
                    in = rt_enter_bounds(rt_vfloat(node->plane[0][slot]), rt_vfloat(node->plane[1][slot]),
                                         rt_vfloat(node->plane[2][slot]), rt_vfloat(node->plane[3][slot]),
                                         rt_vfloat(node->plane[4][slot]), rt_vfloat(node->plane[5][slot]), ray, hit, &entry);
                }
                if (!rt_any(in)) continue;
                stack_node[top] = child;
                stack_t[top] = rt_select(in, entry, RT_INFINITY);
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
#endif
}
