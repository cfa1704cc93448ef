/* polygon.h -- ray/planar polygon on lanes, convex or not, as the thesis has it: the hit with the plane is projected along the
 * dominant axis of the normal, and edge crossings of a half line are counted (even-odd rule). */
RT_INLINE void RT_FN(rt_hit_polygon)(const rt_ctx *ctx, const global rt_leaf *leaf, uint at, const rt_rays *r, rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    const float nx = leaf->a[0], ny = leaf->a[1], nz = leaf->a[2];
    const vfloat zero = rt_vfloat(0.0f);
    const vfloat facing = fma(rt_vfloat(nx), r->dx, fma(rt_vfloat(ny), r->dy, rt_vfloat(nz) * r->dz));
    const vfloat height = rt_vfloat(leaf->b[0]) - fma(rt_vfloat(nx), r->ox, fma(rt_vfloat(ny), r->oy, rt_vfloat(nz) * r->oz));
    const vfloat t = height / facing;
    vmask closer = RT_MASK(facing != zero) & RT_MASK(h->t >= zero) & rt_closer(r, h, t, leaf->prim);
    if (!rt_any(closer)) return;

    const rt_polygon polygon = ctx->polygons[RT_REF_INDEX(leaf->ref)];
    const vfloat x = fma(t, r->dx, r->ox), y = fma(t, r->dy, r->oy), z = fma(t, r->dz, r->oz);
    const vfloat px = polygon.axis == 0u ? y : polygon.axis == 1u ? z : x;
    const vfloat py = polygon.axis == 0u ? z : polygon.axis == 1u ? x : y;
    const global float *corners = ctx->polygon_corners + 2u * polygon.first;
    vmask inside = RT_MASK(zero != zero);
    float x0 = corners[2u * polygon.count - 2u], y0 = corners[2u * polygon.count - 1u];
    for (uint i = 0; i < polygon.count; ++i) {
        const float x1 = corners[2u * i], y1 = corners[2u * i + 1u];
        /* An edge is crossed where its ends lie on different sides of the half line; half-open, so a corner counts once. */
        const vmask straddles = RT_MASK(rt_vfloat(y0) > py) ^ RT_MASK(rt_vfloat(y1) > py);
        const float slope = y1 != y0 ? (x1 - x0) / (y1 - y0) : 0.0f;
        const vmask left = RT_MASK(px < fma(py - rt_vfloat(y0), rt_vfloat(slope), rt_vfloat(x0)));
        inside ^= straddles & left;
        x0 = x1;
        y0 = y1;
    }
    closer &= inside;
    if (!rt_any(closer)) return;
    RT_FN(rt_record)(h, closer, t, zero, zero, rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), (int)at, leaf->prim);
}
