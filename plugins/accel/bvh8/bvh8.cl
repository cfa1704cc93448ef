/* bvh8.cl -- one ray against eight boxes, or RT_LANES rays against one box after the other. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
#if RT_LANES == 1
    /* Near and far planes by the signs of the direction: first rows of either. */
    const uint near_x = ray->ix < 0.0f ? 3u : 0u, near_y = ray->iy < 0.0f ? 4u : 1u, near_z = ray->iz < 0.0f ? 5u : 2u;
    const float8 ix = (float8)(ray->ix), iy = (float8)(ray->iy), iz = (float8)(ray->iz);
    /* Put off: entry distance in the upper half, child in the lower; entries are not negative, so they sort as they are. */
    ulong stack[BVH8_STACK];
    uint top = 0, at = root;
    for (;;) {
        if (at & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(at), count = BVH8_LEAF_COUNT(at);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, 1u);
            const global bvh8_node *n = ctx->bvh8_nodes + at;
            const global float8 *plane = (const global float8 *)n->plane;
            const float8 ax = fma(ix, plane[near_x], (float8)(ray->near_x));
            const float8 ay = fma(iy, plane[near_y], (float8)(ray->near_y));
            const float8 az = fma(iz, plane[near_z], (float8)(ray->near_z));
            const float8 bx = fma(ix, plane[3u - near_x], (float8)(ray->far_x));
            const float8 by = fma(iy, plane[5u - near_y], (float8)(ray->far_y));
            const float8 bz = fma(iz, plane[7u - near_z], (float8)(ray->far_z));
            const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(ray->t_min)));
            const float8 out = rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, (float8)(hit->t));
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                float entry[8];
                vstore8(in, 0, entry);
                uint i = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    at = n->child[i];
                    continue;
                }
                ulong nearest = (ulong)as_uint(entry[i]) << 32 | n->child[i];
                const uint base = top;
                do {
                    i = BVH8_LOWEST(bits);
                    bits &= bits - 1u;
                    const ulong key = (ulong)as_uint(entry[i]) << 32 | n->child[i];
                    const ulong later = key < nearest ? nearest : key;
                    nearest = key < nearest ? key : nearest;
                    uint to = top;
                    for (; to > base && stack[to - 1u] < later; --to) stack[to] = stack[to - 1u];
                    stack[to] = later;
                    if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;
                } while (bits != 0u);
                at = (uint)nearest;
                continue;
            }
        }
        ulong next;
        do {
            if (top == 0u) return;
            next = stack[--top];
        } while (as_float((uint)(next >> 32)) > hit->t);
        at = (uint)next;
    }
#else
    vfloat stack_t[BVH8_STACK];
    uint stack_node[BVH8_STACK];
    uint top = 0, at = root;
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
            const global bvh8_node *n = ctx->bvh8_nodes + at;
            for (uint i = 0; i < BVH8_WIDTH; ++i) {
                const uint child = n->child[i];
                if (child == BVH8_NOTHING) continue;
                vfloat entry;
                const vmask in = rt_enter_bounds(rt_vfloat(n->plane[0][i]), rt_vfloat(n->plane[1][i]), rt_vfloat(n->plane[2][i]),
                                                 rt_vfloat(n->plane[3][i]), rt_vfloat(n->plane[4][i]), rt_vfloat(n->plane[5][i]),
                                                 ray, hit, &entry);
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
