/* query.h -- a query of the whole scene: planes first, then the tree of group 0. A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_trace)(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *ray, rt_hits *hit)
{
#if RT_HAS_PLANES
    RT_FN(rt_hit_planes)(ctx, frame->plane_count, ray, hit);
#if RT_ANY_HIT
    if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
#endif
    RT_FN(rt_scene)(ctx, frame->root, ray, hit);
}

/* The same for `count` packets. A packet without active lanes, which has hit.t = -1 in all, need not be prepared. */
RT_INLINE void RT_FN(rt_trace_stream)(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *rays, rt_hits *hits, uint count)
{
#if RT_STREAM == 1
    if (rt_any(RT_MASK(hits->t >= rt_vfloat(0.0f)))) RT_FN(rt_trace)(ctx, frame, rays, hits);
#else
#if RT_HAS_PLANES
    for (uint b = 0; b < count; ++b)
        if (rt_any(RT_MASK(hits[b].t >= rt_vfloat(0.0f)))) RT_FN(rt_hit_planes)(ctx, frame->plane_count, rays + b, hits + b);
#endif
    RT_FN(rt_scene_stream)(ctx, frame->root, rays, hits, count);
#endif
}
