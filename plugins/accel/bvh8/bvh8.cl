/* bvh8.cl -- one ray against eight boxes, or RT_LANES rays against one box after the other. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    uint top = 0, at = root;
#if RT_LANES == 1
    /* Near and far planes by the signs of the direction: rows of a node. */
    const ulong near_x = ray->ix < 0.0f ? 96u : 0u, near_y = ray->iy < 0.0f ? 128u : 32u, near_z = ray->iz < 0.0f ? 160u : 64u;
    const ulong far_x = 96u - near_x, far_y = 160u - near_y, far_z = 224u - near_z;
#define BVH8_ROW(offset) (*(const global float8 *)(node + (offset)))
    const float8 ix = (float8)(ray->ix), iy = (float8)(ray->iy), iz = (float8)(ray->iz);
    const float8 wx = ix * RT_WIDE, wy = iy * RT_WIDE, wz = iz * RT_WIDE;
    const float8 fx = (float8)(ray->far_x * RT_WIDE), fy = (float8)(ray->far_y * RT_WIDE), fz = (float8)(ray->far_z * RT_WIDE);
    /* Put off: entry distance in the upper half, child in the lower; entries are not negative, so they sort as they are. */
    ulong stack[BVH8_STACK];
#define BVH8_KEY(i) ((ulong)as_uint(entry[i]) << 32 | child[i])
    for (;;) {
        if (at & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(at), count = BVH8_LEAF_COUNT(at);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, 1u);
            const global char *node = (const global char *)(ctx->bvh8_nodes + at);
            const float8 ax = fma(ix, BVH8_ROW(near_x), (float8)(ray->near_x));
            const float8 ay = fma(iy, BVH8_ROW(near_y), (float8)(ray->near_y));
            const float8 az = fma(iz, BVH8_ROW(near_z), (float8)(ray->near_z));
            const float8 bx = fma(wx, BVH8_ROW(far_x), fx);
            const float8 by = fma(wy, BVH8_ROW(far_y), fy);
            const float8 bz = fma(wz, BVH8_ROW(far_z), fz);
            const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(ray->t_min)));
            const float8 out = rt_min(rt_min(bx, by), rt_min(bz, (float8)(hit->t)));
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                const global uint *child = (const global uint *)(node + 192);
                uint i = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    at = child[i];
                    continue;
                }
                float entry[8];
                vstore8(in, 0, entry);
                ulong a = BVH8_KEY(i);
                i = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                ulong b = BVH8_KEY(i);
                ulong nearest = min(a, b), second = max(a, b);
                if (bits == 0u) {
                    stack[top++] = second;
                    at = (uint)nearest;
                    continue;
                }
                i = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                a = BVH8_KEY(i);
                b = max(a, second);
                a = min(a, second);
                second = max(a, nearest);
                nearest = min(a, nearest);
                const uint base = top;
                stack[top++] = b;
                stack[top++] = second;
                while (bits != 0u) {
                    i = BVH8_LOWEST(bits);
                    bits &= bits - 1u;
                    const ulong key = BVH8_KEY(i);
                    const ulong later = max(key, nearest);
                    nearest = min(key, nearest);
                    uint to = top;
                    for (; to > base && stack[to - 1u] < later; --to) stack[to] = stack[to - 1u];
                    stack[to] = later;
                    ++top;
                }
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
