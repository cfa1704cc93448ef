/* plane.h -- unbounded planes on lanes. No tree can hold them: all are tested before traversal, which also shortens the rays. */
RT_INLINE void RT_FN(rt_hit_planes)(const rt_ctx *ctx, uint count, const rt_rays *r, rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    for (uint i = 0; i < count; ++i) {
        const global rt_plane *plane = ctx->planes + i;
        const vfloat nx = rt_vfloat(plane->normal[0]), ny = rt_vfloat(plane->normal[1]), nz = rt_vfloat(plane->normal[2]);
        const vfloat facing = fma(nx, r->dx, fma(ny, r->dy, nz * r->dz));
        const vfloat height = rt_vfloat(plane->offset) - fma(nx, r->ox, fma(ny, r->oy, nz * r->oz));
        const vfloat t = height / facing, zero = rt_vfloat(0.0f);
        const vmask closer = RT_MASK(facing != zero) & RT_MASK(h->t >= zero) & rt_closer(r, h, t, plane->prim);
        if (!rt_any(closer)) continue;
        RT_FN(rt_record)(h, closer, t, zero, zero, nx, ny, nz, -2 - (int)i, plane->prim);
    }
}
