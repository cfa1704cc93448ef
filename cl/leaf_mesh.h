/* leaf_mesh.h -- RT_LEAF within a mesh: triangles only. A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_leaf_mesh)(const rt_ctx *ctx, uint at, const rt_rays *ray, rt_hits *hit)
{
    RT_COUNT_LEAF(hit);
    RT_FN(rt_hit_triangle)(ctx->leaves + at, at, ray, hit);
}
