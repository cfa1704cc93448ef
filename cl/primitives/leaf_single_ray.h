/* leaf_single_ray.h -- one ray of a packet against the primitives of a leaf, eight at most, in two steps.
 *
 * RT_SINGLE_RAY_CANDIDATES returns the bits of those that the ray may hit, without a branch where leaves are small.
 * RT_SINGLE_RAY_TEST tests those. A traversal of several rays does the first step for all of them before the second, so that
 * the second step's branches are decided early. RT_SINGLE_RAY_MIXED is 1 if a leaf may hold more than triangles. A template,
 * see CONTRACT.md. */
RT_INLINE uint RT_SINGLE_RAY_CANDIDATES(const rt_ctx *ctx, uint first, uint count, const rt_single_rays *single, uint l)
{
    const global rt_packed_prim *leaf = ctx->leaves + first;
    RT_HOST_COUNT(single, tests, count);
    uint bits = rt_row_candidates(single, l, leaf);
    if (count > RT_ROW) bits |= rt_row_candidates(single, l, leaf + RT_ROW) << RT_ROW;
#if RT_SINGLE_RAY_MIXED
    for (uint i = 0; i < count; ++i)
        if (RT_REF_KIND(leaf[i].ref) != RT_REF_TRIANGLE) bits |= 1u << i;
#endif
    return bits & ((1u << count) - 1u);
}

/* `ray` and `hit` are the packet's, for primitives that are tested on lanes; the other lanes are inactive meanwhile. */
RT_INLINE void RT_SINGLE_RAY_TEST(const rt_ctx *ctx, uint first, uint bits, const rt_single_rays *single, uint l, rt_single_hits *single_hit,
                            const rt_rays *ray, rt_hits *hit)
{
    for (; bits != 0u; bits &= bits - 1u) {
        const uint at = first + rt_lowest(bits);
#if RT_SINGLE_RAY_MIXED
        if (RT_REF_KIND(ctx->leaves[at].ref) != RT_REF_TRIANGLE) {
            RT_HOST_COUNT(single, tests, -1u); /* RT_LEAF counts it, unless it is an instance */
#if RT_LANES == 1
            RT_LEAF(ctx, at, ray, hit);
#else
            const vmask is_this = RT_MASK(rt_lane_index() == rt_vint((int)l));
            rt_gather_hits(single_hit, hit);
            const vfloat others = hit->t;
            hit->t = rt_select(is_this, others, rt_vfloat(-1.0f));
            RT_LEAF(ctx, at, ray, hit);
            hit->t = rt_select(is_this, hit->t, others);
            rt_spread_hits(hit, single_hit);
#endif
        } else
#endif
            RT_FN(rt_hit_triangle_single_ray)(ctx->leaves + at, at, single, l, single_hit);
#if RT_ANY_HIT
        if (RT_AT(single_hit->t, l) < 0.0f) return;
#endif
    }
}
