/* leaf_mesh.h -- RT_LEAF within a mesh, where all primitives are triangles; whole, and as RT_LEAF_CANDIDATE and RT_LEAF_TEST. A
 * template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_leaf_mesh)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_HOST_COUNT(ray, tests, 1u);
    RT_FN(rt_hit_triangle)(ctx->leaves + at, at, ray, hit);
}

#if RT_CPU
RT_INLINE uint RT_FN(rt_leaf_mesh_candidate)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_HOST_COUNT(ray, tests, 1u);
    return RT_FN(rt_maybe_triangle)(ctx->leaves + at, ray, hit);
}

RT_INLINE void RT_FN(rt_leaf_mesh_test)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_FN(rt_hit_triangle)(ctx->leaves + at, at, ray, hit);
}
#endif
