/* double_leaf.h -- each leaf test done twice, for `clarity bench --breakdown`.
 *
 * The time that a frame takes longer is the time of its leaf tests. The second test finds the same hit at the same distance, so
 * it changes nothing. It reads the primitive from an address that the compiler cannot know to be the same, so it is not
 * optimised away. An instance is a traversal and no leaf test, so it is entered once. A template, see CONTRACT.md. */
#if RT_LEAF_INSTANCES
#define RT_AGAIN(ctx, at) (RT_REF_KIND((ctx)->leaves[at].ref) != RT_REF_INSTANCE)
#else
#define RT_AGAIN(ctx, at) 1
#endif
/* Equal to `at`, whatever an importer left in the padding. The compiler cannot know that the padding is 0. */
#define RT_SAME_PLACE(ctx, at) min((at) + (ctx)->materials->pad, (at))

RT_INLINE void RT_LEAF(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_LEAF_ONCE(ctx, at, ray, hit);
    if (RT_AGAIN(ctx, at)) RT_LEAF_ONCE(ctx, RT_SAME_PLACE(ctx, at), ray, hit);
}

#ifdef RT_SINGLE_RAY_TEST_ONCE
RT_INLINE uint RT_LEAF_CANDIDATE(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    return RT_LEAF_CANDIDATE_ONCE(ctx, at, ray, hit) & RT_LEAF_CANDIDATE_ONCE(ctx, RT_SAME_PLACE(ctx, at), ray, hit);
}

RT_INLINE void RT_LEAF_TEST(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_LEAF_TEST_ONCE(ctx, at, ray, hit);
    if (RT_AGAIN(ctx, at)) RT_LEAF_TEST_ONCE(ctx, RT_SAME_PLACE(ctx, at), ray, hit);
}

RT_INLINE uint RT_SINGLE_RAY_CANDIDATES(const rt_ctx *ctx, uint first, uint count, const rt_single_rays *single, uint l)
{
    return RT_SINGLE_RAY_CANDIDATES_ONCE(ctx, first, count, single, l) &
           RT_SINGLE_RAY_CANDIDATES_ONCE(ctx, RT_SAME_PLACE(ctx, first), count, single, l);
}

RT_INLINE void RT_SINGLE_RAY_TEST(const rt_ctx *ctx, uint first, uint bits, const rt_single_rays *single, uint l, rt_single_hits *single_hit,
                            const rt_rays *ray, rt_hits *hit)
{
    RT_SINGLE_RAY_TEST_ONCE(ctx, first, bits, single, l, single_hit, ray, hit);
#if RT_LEAF_INSTANCES
    for (uint i = 0; i < 8u; ++i)
        if ((bits >> i & 1u) != 0u && !RT_AGAIN(ctx, first + i)) bits &= ~(1u << i);
#endif
    RT_SINGLE_RAY_TEST_ONCE(ctx, RT_SAME_PLACE(ctx, first), bits, single, l, single_hit, ray, hit);
}
#endif
#undef RT_AGAIN
#undef RT_SAME_PLACE
