/* query.h -- a query of the whole scene: planes first, then the tree of group 0. A template, see CONTRACT.md. */
RT_TRAVERSAL void RT_FN(rt_trace)(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *ray, rt_hits *hit)
{
#if RT_HAS_PLANES
    RT_FN(rt_hit_planes)(ctx, frame->plane_count, ray, hit);
#if RT_ANY_HIT
    if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
#endif
#ifdef RT_COUNT_STEPS
    const rt_hits before = *hit;
    rt_counts counted = {0u};
    ((rt_rays *)ray)->counts = &counted;
#endif
    RT_FN(rt_scene)(ctx, frame->root, ray, hit);
#ifdef RT_COUNT_STEPS
    rt_finish_counters(ray, hit, &before, &counted);
#endif
}

/* The same for `count` packets. A packet without active lanes, which has hit.t = -1 in all, need not be prepared. Programs with both queries have
 * a function for each: with both traversals inside of the kernel, a cold start of `bvh8` with 8 and 16 lanes takes 1.3 times as long. */
#if RT_STREAM > 1 && RT_QUERIES > 1
RT_NOINLINE
#else
RT_INLINE
#endif
void RT_FN(rt_trace_stream)(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *rays, rt_hits *hits, uint count)
{
#if RT_STREAM == 1
    if (rt_any(RT_MASK(hits->t >= rt_vfloat(0.0f)))) RT_FN(rt_trace)(ctx, frame, rays, hits);
#else
#if RT_HAS_PLANES
    for (uint b = 0; b < count; ++b)
        if (rt_any(RT_MASK(hits[b].t >= rt_vfloat(0.0f)))) RT_FN(rt_hit_planes)(ctx, frame->plane_count, rays + b, hits + b);
#endif
#ifdef RT_COUNT_STEPS
    rt_counts counted[RT_STREAM];
    rt_hits before[RT_STREAM];
    for (uint b = 0; b < count; ++b) {
        const rt_counts none = {0u};
        before[b] = hits[b];
        counted[b] = none;
        ((rt_rays *)rays)[b].counts = counted + b;
    }
#endif
    RT_FN(rt_scene_stream)(ctx, frame->root, rays, hits, count);
#ifdef RT_COUNT_STEPS
    for (uint b = 0; b < count; ++b) rt_finish_counters(rays + b, hits + b, before + b, counted + b);
#endif
#endif
}
