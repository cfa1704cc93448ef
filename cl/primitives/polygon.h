/* polygon.h -- watertight ray/polygon test on lanes, for planar polygons, convex or not.
 *
 * Corners are taken to ray space by the arithmetic of triangle.h. The test counts the edges that a half line from the ray
 * crosses there (even-odd rule). Whether it crosses an edge follows from the edge's two corners alone and is the same in either
 * direction. So the polygons at an edge agree on it, whatever rounding did, and a ray that passes from one to the other meets
 * an odd number of them. The edge function decides only where the corners lie on different sides of the half line's axis. Its
 * sign is right or it is zero, and a zero is no crossing for both polygons. A template, see CONTRACT.md. */
#define RT_PROJECT(at, x, y, z) rt_to_ray_space(r, at, (float4)((at)[0], (at)[1], (at)[2], 0.0f), x, y, z);
RT_INLINE void RT_FN(rt_hit_polygon)(const rt_ctx *ctx, const global rt_packed_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    const rt_polygon polygon = ctx->polygons[RT_REF_INDEX(leaf->ref)];
    const global float *corners = ctx->polygon_corners + 3ul * polygon.first;
    const vfloat zero = rt_vfloat(0.0f);
    vfloat x0, y0, z0;
    RT_PROJECT(corners + 3u * (polygon.count - 1u), &x0, &y0, &z0)
    vfloat nearest = z0, farthest = z0;
    vmask above0 = RT_MASK(y0 > zero), inside = RT_MASK(zero != zero);
    for (uint i = 0; i < polygon.count; ++i) {
        vfloat x1, y1, z1;
        RT_PROJECT(corners + 3u * i, &x1, &y1, &z1)
        const vmask above1 = RT_MASK(y1 > zero); /* half-open, so a corner counts once */
        const vfloat edge = RT_EDGE(x0, y0, x1, y1);
        inside ^= (above0 ^ above1) & rt_select(above1, RT_MASK(edge > zero), RT_MASK(edge < zero));
        nearest = rt_min(nearest, z1);
        farthest = rt_max(farthest, z1);
        x0 = x1;
        y0 = y1;
        above0 = above1;
    }
    inside &= RT_MASK(h->t >= zero);
    if (!rt_any(inside)) return;

    const float nx = leaf->a[0], ny = leaf->a[1], nz = leaf->a[2];
    const vfloat facing = RT_DOT(rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), r->dx, r->dy, r->dz);
    const vfloat height = RT_DOT(rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), rt_vfloat(leaf->b[0]) - r->ox,
                                 rt_vfloat(leaf->b[1]) - r->oy, rt_vfloat(leaf->b[2]) - r->oz);
    const vfloat ta = -nearest * r->sz, tb = -farthest * r->sz;
    const vfloat t = RT_PLANE_DISTANCE(height, facing, rt_min(ta, tb), rt_max(ta, tb));
    const vmask closer = inside & rt_closer(r, h, t, leaf->prim);
    if (!rt_any(closer)) return;
    RT_FN(rt_record)(h, closer, t, zero, zero, rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), (int)at, leaf->prim);
}
#undef RT_PROJECT
