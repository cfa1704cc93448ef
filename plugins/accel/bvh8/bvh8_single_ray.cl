/* bvh8_single_ray.cl -- one ray against all eight children of a node at once, for programs of one lane.
 *
 * Wald, Benthin, Boulos 2008, "Getting Rid of Packets". The nearest child is visited next, the others are deferred in the order
 * of their distances. Most nodes leave one or two children. Branches on their number cost less than sorting vectors of eight: a
 * sorting network in registers took a tenth longer, and so did compressing stores of all children in the order of the slots. An
 * any-hit query does not order them: it visits nearly as few nodes, each for less. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    uint top = 0, ref = root;
    const bvh8_rows rows = bvh8_rows_of(ray->ix < 0.0f, ray->iy < 0.0f, ray->iz < 0.0f);
    /* The far side is widened here instead of in each node. That rounds twice more, each time by half an ulp of origin /
     * direction or of the distance. The slack of rt_prepare_for_boxes() and RT_WIDE have room for both. */
    const bvh8_slab_ray slab = {ray->ix,           ray->iy,           ray->iz,           ray->near_x,          ray->near_y,
                                ray->near_z,       ray->ix * RT_WIDE, ray->iy * RT_WIDE, ray->iz * RT_WIDE,    ray->far_x * RT_WIDE,
                                ray->far_y * RT_WIDE, ray->far_z * RT_WIDE};
#if RT_ANY_HIT
    uint stack[BVH8_STACK];
#else
    ulong stack[BVH8_STACK];
#endif
#define BVH8_PUSH(entry)                                                                                                       \
    {                                                                                                                          \
        stack[top] = entry;                                                                                                    \
        if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;                                                                     \
    }
    for (;;) {
        if (ref & BVH8_LEAF) {
            const uint first = BVH8_LEAF_FIRST(ref), count = BVH8_LEAF_COUNT(ref);
#if RT_CPU
            RT_SINGLE_RAY_TEST(ctx, first, RT_SINGLE_RAY_CANDIDATES(ctx, first, count, ray, 0u), ray, 0u, hit, ray, hit);
#else
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#endif
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, 1u);
            RT_COUNT_BOXES(hit, BVH8_WIDTH);
            const global char *node = (const global char *)RT_NODE(ray, ctx->bvh8_nodes + ref);
            float8 in, out;
            bvh8_intersect(node, &rows, &slab, ray->t_min, hit->t, &in, &out);
            uint bits = BVH8_BITS(in <= out);
            if (bits != 0u) {
                const global uint *child = BVH8_CHILDREN(node);
#if RT_ANY_HIT
                ref = child[rt_lowest(bits)];
                for (bits &= bits - 1u; bits != 0u; bits &= bits - 1u) BVH8_PUSH(child[rt_lowest(bits)])
                continue;
#else
                uint i = rt_lowest(bits);
                bits &= bits - 1u;
                if (bits == 0u) {
                    ref = child[i];
                    continue;
                }
                float distance[BVH8_WIDTH];
                vstore8(in, 0, distance);
                ulong entry = BVH8_ENTRY(distance[i], child[i]);
                i = rt_lowest(bits);
                bits &= bits - 1u;
                ulong other = BVH8_ENTRY(distance[i], child[i]);
                ulong nearest = min(entry, other), second = max(entry, other);
                if (bits != 0u) {
                    i = rt_lowest(bits);
                    bits &= bits - 1u;
                    entry = BVH8_ENTRY(distance[i], child[i]);
                    other = min(entry, second);
                    const uint base = top;
                    BVH8_PUSH(max(entry, second))
                    second = max(other, nearest);
                    nearest = min(other, nearest);
                    for (; bits != 0u; bits &= bits - 1u) {
                        /* Inserts the farther ones between `base` and the top, the farthest lowest. */
                        i = rt_lowest(bits);
                        entry = BVH8_ENTRY(distance[i], child[i]);
                        other = max(entry, second);
                        entry = min(entry, second);
                        uint to = top;
                        for (; to > base && stack[to - 1u] < other; --to) stack[to] = stack[to - 1u];
                        stack[to] = other;
                        if (RT_STACK_OK(top + 1u, BVH8_STACK, hit)) ++top;
                        second = max(entry, nearest);
                        nearest = min(entry, nearest);
                    }
                }
                BVH8_PUSH(second)
                ref = (uint)nearest;
                continue;
#endif
            }
        }
#if RT_ANY_HIT
        if (top == 0u) return;
        ref = stack[--top];
#else
        ulong next;
        do {
            if (top == 0u) return;
            next = stack[--top];
        } while (BVH8_ENTRY_T(next) > hit->t);
        ref = (uint)next;
#endif
    }
#undef BVH8_PUSH
}
