/* query.h -- a whole query of the scene: planes, then the tree of group 0. A template, see CONTRACT.md. */
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
