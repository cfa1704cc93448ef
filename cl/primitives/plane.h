/* plane.h -- unbounded planes on lanes. No tree can hold a plane. All are tested before the traversal, which shortens the rays.
 * A template, see CONTRACT.md. */
RT_INLINE void RT_FN(rt_hit_planes)(const rt_ctx *ctx, uint count, const rt_rays *r, rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    for (uint i = 0; i < count; ++i) {
        const global rt_plane *plane = ctx->planes + i;
        const vfloat nx = rt_vfloat(plane->normal[0]), ny = rt_vfloat(plane->normal[1]), nz = rt_vfloat(plane->normal[2]);
        const vfloat facing = RT_DOT(nx, ny, nz, r->dx, r->dy, r->dz);
        const vfloat height = rt_vfloat(plane->offset) - RT_DOT(nx, ny, nz, r->ox, r->oy, r->oz);
        const vfloat t = height / facing, zero = rt_vfloat(0.0f);
        const vmask closer = RT_MASK(facing != zero) & RT_MASK(h->t >= zero) & rt_closer(r, h, t, plane->prim);
        if (!rt_any(closer)) continue;
        RT_FN(rt_record)(h, closer, t, zero, zero, nx, ny, nz, -2 - (int)i, plane->prim);
    }
}
