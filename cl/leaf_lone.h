/* leaf_lone.h -- RT_LONE_LEAVES: one ray of a packet against the primitives of a leaf. A template, see CONTRACT.md; included
 * once for meshes, where RT_LONE_MIXED is 0, and once for the scene, where it says whether there is more than triangles.
 *
 * `ray` and `hit` are the packet, for primitives that are tested on lanes: then all others wait. */
RT_INLINE void RT_LONE_LEAVES(const rt_ctx *ctx, uint first, uint count, const rt_lone_rays *lone, uint l, rt_lone_hits *lone_hit,
                              const rt_rays *ray, rt_hits *hit)
{
    for (;;) {
        const global rt_leaf *leaf = ctx->leaves + first;
        uint bits = rt_row_candidates(lone, l, leaf);
#if RT_LONE_MIXED
        for (uint i = 0; i < min(count, RT_ROW); ++i)
            if (RT_REF_KIND(leaf[i].ref) != RT_REF_TRIANGLE)
                bits |= 1u << i;
            else
                RT_COUNT_LEAF(hit);
#else
        RT_COUNT_LEAVES(hit, min(count, RT_ROW));
#endif
        if (count < RT_ROW) bits &= (1u << count) - 1u;
        for (; bits != 0u; bits &= bits - 1u) {
            const uint i = popcount(~bits & (bits - 1u));
#if RT_LONE_MIXED
            if (RT_REF_KIND(leaf[i].ref) != RT_REF_TRIANGLE) {
#if RT_LANES == 1
                RT_LEAF(ctx, first + i, ray, hit);
#else
                rt_gather_hits(lone_hit, hit);
                hit->t = rt_select(RT_MASK(rt_lane_index() == rt_vint((int)l)), hit->t, rt_vfloat(-1.0f));
                RT_LEAF(ctx, first + i, ray, hit);
                const vfloat others = rt_load(lone_hit->t);
                hit->t = rt_select(RT_MASK(rt_lane_index() == rt_vint((int)l)), hit->t, others);
                rt_spread_hits(hit, lone_hit);
#endif
            } else
#endif
                RT_FN(rt_hit_lone_triangle)(leaf + i, first + i, lone, l, lone_hit);
#if RT_ANY_HIT
            if (RT_AT(lone_hit->t, l) < 0.0f) return;
#endif
        }
        if (count <= RT_ROW) return;
        first += RT_ROW;
        count -= RT_ROW;
    }
}
