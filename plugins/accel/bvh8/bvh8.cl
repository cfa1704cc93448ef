/* bvh8.cl -- a tree of eight children a node, three ways to go down it.
 *
 * A packet whose directions agree in sign goes by its bounds: intervals of its origins and of its reciprocal directions give one
 * slab test that no ray of the packet can beat, against all eight children at once (Reshetov, Soupikov, Hurley 2005, "Multi-Level
 * Ray Tracing Algorithm"; Boulos, Wald, Shirley 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets"). Before
 * a leaf the rays themselves are tested, and before a node too where the bounds are wide. Next to a test of all rays against one
 * box after the other it halves the work of a node.
 *
 * Other packets test their rays against one box after the other, or, BVH8_SINGLE, each ray goes alone: where a tree outgrows the
 * caches, rays that share few nodes only fetch more of them together.
 *
 * A single ray is tested against all eight boxes, takes the nearest child and puts the others off in the order of their
 * distances. Most nodes leave one or two children, and branching on their number costs less than sorting vectors of eight: a
 * network in registers took a tenth longer, and so did putting all off in the order of the slots by compressing stores. Where any
 * hit will do, order is worth nothing: nearly as few nodes are visited without it, each for less. */
#define BVH8_LONE RT_CAT(RT_TRAVERSE, _lone)
#define BVH8_ENTER RT_CAT(RT_TRAVERSE, _enter)
#define BVH8_BOUNDED RT_CAT(RT_TRAVERSE, _bounded)
#define BVH8_APART RT_CAT(RT_TRAVERSE, _apart)

#if RT_LANES == 1 || BVH8_SINGLE
RT_INLINE void BVH8_LONE(const rt_ctx *ctx, uint at, const rt_lone_rays *lone, uint l, rt_lone_hits *lone_hit, const rt_rays *ray,
                         rt_hits *hit)
{
    uint top = 0;
    const ulong near_x = RT_AT(lone->ix, l) < 0.0f ? 96u : 0u, near_y = RT_AT(lone->iy, l) < 0.0f ? 128u : 32u, near_z = RT_AT(lone->iz, l) < 0.0f ? 160u : 64u;
    const ulong far_x = 96u - near_x, far_y = 160u - near_y, far_z = 224u - near_z;
    const float8 ix = (float8)(RT_AT(lone->ix, l)), iy = (float8)(RT_AT(lone->iy, l)), iz = (float8)(RT_AT(lone->iz, l));
    /* The far side is widened here instead of in each node: that rounds twice more, each time by half an ulp of origin /
     * direction or of the distance, for which the slack of rt_prepare and RT_WIDE have room. */
    const float8 wide_x = ix * RT_WIDE, wide_y = iy * RT_WIDE, wide_z = iz * RT_WIDE;
    const float8 exit_x = (float8)(RT_AT(lone->far_x, l) * RT_WIDE), exit_y = (float8)(RT_AT(lone->far_y, l) * RT_WIDE),
                 exit_z = (float8)(RT_AT(lone->far_z, l) * RT_WIDE);
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
            RT_LONE_LEAVES(ctx, first, count, lone, l, lone_hit, ray, hit);
#else
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#endif
#if RT_ANY_HIT
            if (RT_AT(lone_hit->t, l) < 0.0f) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, 1u);
            const global char *node = (const global char *)(ctx->bvh8_nodes + at);
            const float8 ax = fma(ix, BVH8_ROW(node, near_x), (float8)(RT_AT(lone->near_x, l)));
            const float8 ay = fma(iy, BVH8_ROW(node, near_y), (float8)(RT_AT(lone->near_y, l)));
            const float8 az = fma(iz, BVH8_ROW(node, near_z), (float8)(RT_AT(lone->near_z, l)));
            const float8 bx = fma(wide_x, BVH8_ROW(node, far_x), exit_x);
            const float8 by = fma(wide_y, BVH8_ROW(node, far_y), exit_y);
            const float8 bz = fma(wide_z, BVH8_ROW(node, far_z), exit_z);
            const float8 in = rt_max(rt_max(ax, ay), rt_max(az, (float8)(RT_AT(lone->t_min, l))));
            const float8 out = rt_min(rt_min(bx, by), rt_min(bz, (float8)(RT_AT(lone_hit->t, l))));
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
        } while (as_float((uint)(next >> 32)) > RT_AT(lone_hit->t, l));
        at = (uint)next;
#endif
    }
#undef BVH8_PUSH
}
#endif

#if RT_LANES == 1

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    BVH8_LONE(ctx, root, ray, 0u, hit, ray, hit);
}

#else

/* Rays against the box of one child, whose rows are near_x .. far_z bytes from `box`. */
RT_INLINE uint BVH8_ENTER(const global char *box, ulong near_x, ulong near_y, ulong near_z, const rt_rays *ray, const rt_hits *hit)
{
    const vfloat ax = fma(ray->ix, BVH8_PLANE(box, near_x), ray->near_x), bx = fma(ray->ix, BVH8_PLANE(box, 96u - near_x), ray->far_x);
    const vfloat ay = fma(ray->iy, BVH8_PLANE(box, near_y), ray->near_y), by = fma(ray->iy, BVH8_PLANE(box, 160u - near_y), ray->far_y);
    const vfloat az = fma(ray->iz, BVH8_PLANE(box, near_z), ray->near_z), bz = fma(ray->iz, BVH8_PLANE(box, 224u - near_z), ray->far_z);
    const vfloat entry = rt_max(rt_max(ax, ay), rt_max(az, ray->t_min));
    return rt_bits(RT_MASK(entry <= rt_min(rt_min(rt_min(bx, by), bz) * RT_WIDE, hit->t)));
}

/* A packet whose active directions agree in sign. */
RT_INLINE void BVH8_BOUNDED(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    const vmask alive = RT_MASK(hit->t >= rt_vfloat(0.0f));
    const float t_min = rt_least_of(alive, ray->t_min);
    float t_far = rt_greatest(hit->t);
    const ulong near_x = ray->lo_x * 32u, near_y = ray->lo_y * 32u, near_z = ray->lo_z * 32u;
    const ulong far_x = 96u - near_x, far_y = 160u - near_y, far_z = 224u - near_z;
    /* A plane p is met at (p - origin) / direction. With x = p - the origin nearest to it that lies between the least and the
     * greatest of x / direction of any ray; each side as fma(1 / direction, p, -origin / direction), with the slack of
     * rt_prepare(). */
    bool wide = false;
#define BVH8_AXIS(x, turned)                                                                                                     \
    const float o_lo_##x = rt_least_of(alive, ray->o##x), o_hi_##x = rt_greatest_of(alive, ray->o##x);                           \
    const float i_lo_##x = rt_least_of(alive, ray->i##x), i_hi_##x = rt_greatest_of(alive, ray->i##x);                           \
    const float o_in_##x = (turned) ? o_lo_##x : o_hi_##x, o_out_##x = (turned) ? o_hi_##x : o_lo_##x;                           \
    const float8 lo_##x = (float8)(i_lo_##x), hi_##x = (float8)(i_hi_##x);                                                       \
    const float8 in_lo_##x = (float8)(BVH8_DOWN(-o_in_##x * i_lo_##x)), in_hi_##x = (float8)(BVH8_DOWN(-o_in_##x * i_hi_##x));   \
    const float8 out_lo_##x = (float8)(BVH8_UP(-o_out_##x * i_lo_##x)), out_hi_##x = (float8)(BVH8_UP(-o_out_##x * i_hi_##x));   \
    wide |= o_lo_##x != o_hi_##x || i_hi_##x - i_lo_##x > 0.25f * fabs(i_lo_##x);
#define BVH8_DOWN(v) ((v) - fabs(v) * (8.0f * RT_EPS))
#define BVH8_UP(v) ((v) + fabs(v) * (8.0f * RT_EPS))
    BVH8_AXIS(x, near_x != 0u)
    BVH8_AXIS(y, near_y != 32u)
    BVH8_AXIS(z, near_z != 64u)
#define BVH8_IN(x, p) rt_min(fma(p, lo_##x, in_lo_##x), fma(p, hi_##x, in_hi_##x))
#define BVH8_OUT(x, p) rt_max(fma(p, lo_##x, out_lo_##x), fma(p, hi_##x, out_hi_##x))

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
            const float8 in_x = BVH8_IN(x, BVH8_ROW(node, near_x)), in_y = BVH8_IN(y, BVH8_ROW(node, near_y)),
                         in_z = BVH8_IN(z, BVH8_ROW(node, near_z));
            const float8 out_x = BVH8_OUT(x, BVH8_ROW(node, far_x)), out_y = BVH8_OUT(y, BVH8_ROW(node, far_y)),
                         out_z = BVH8_OUT(z, BVH8_ROW(node, far_z));
            const float8 in = rt_max(rt_max(in_x, in_y), rt_max(in_z, (float8)(t_min)));
            const float8 out = rt_min(rt_min(rt_min(out_x, out_y), out_z) * RT_WIDE, (float8)(t_far));
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                const global uint *child = (const global uint *)(node + 192);
                slot = BVH8_LOWEST(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    at = child[slot];
                    continue;
                }
                float entry[BVH8_WIDTH];
                vstore8(in, 0, entry);
#define BVH8_PLACE(i) ((ulong)as_uint(entry[i]) << 32 | (at * 8u + (i)))
                BVH8_PREFETCH(ctx, child[slot]);
                ulong nearest = BVH8_PLACE(slot);
                for (; bits != 0u; bits &= bits - 1u) {
                    const uint i = BVH8_LOWEST(bits);
                    BVH8_PREFETCH(ctx, child[i]);
                    const ulong place = BVH8_PLACE(i);
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
#undef BVH8_AXIS
#undef BVH8_DOWN
#undef BVH8_UP
#undef BVH8_IN
#undef BVH8_OUT
#undef BVH8_PLACE

#if BVH8_SINGLE

RT_INLINE void BVH8_APART(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    rt_lone_rays lone;
    rt_lone_hits lone_hit;
    rt_spread_rays(ray, &lone);
    rt_spread_hits(hit, &lone_hit);
    for (uint todo = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); todo != 0u; todo &= todo - 1u)
        BVH8_LONE(ctx, root, &lone, BVH8_LOWEST(todo), &lone_hit, ray, hit);
    rt_gather_hits(&lone_hit, hit);
}

#else

RT_INLINE void BVH8_APART(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    uint top = 0;
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
}

#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    if (ray->coherent)
        BVH8_BOUNDED(ctx, root, ray, hit);
    else
        BVH8_APART(ctx, root, ray, hit);
}

#endif
