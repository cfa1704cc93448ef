/* triangle.h -- watertight ray/triangle test on lanes.
 *
 * Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection". Corners are projected across the ray by a map that is the
 * same for every triangle, then three 2D edge functions decide. Each is a difference of two rounded products, never fused:
 * rounding is monotone, so its sign is right or it is zero, and the two triangles at an edge compute it from the same numbers.
 * A zero counts as inside, so no ray passes between triangles that share corners; Woop's double-precision fallback would only
 * decide which of the two gets it. */
RT_INLINE void RT_FN(rt_hit_triangle)(const global rt_leaf *leaf, uint at, const rt_rays *r, rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    vfloat ax, ay, bx, by, cx, cy;
#if RT_LANES > 1
    if (r->same_axis) {
        /* Corners relative to the origin, negated: both products of an edge function change sign twice. */
        const vfloat o_x = r->kz == 2u ? r->ox : r->kz == 1u ? r->oz : r->oy;
        const vfloat o_y = r->kz == 2u ? r->oy : r->kz == 1u ? r->ox : r->oz;
        const vfloat o_z = r->kz == 2u ? r->oz : r->kz == 1u ? r->oy : r->ox;
        const vfloat az = o_z - rt_vfloat(leaf->a[r->kz]);
        const vfloat bz = o_z - rt_vfloat(leaf->b[r->kz]);
        const vfloat cz = o_z - rt_vfloat(leaf->c[r->kz]);
        ax = fma(r->sx, az, o_x - rt_vfloat(leaf->a[r->kx]));
        ay = fma(r->sy, az, o_y - rt_vfloat(leaf->a[r->ky]));
        bx = fma(r->sx, bz, o_x - rt_vfloat(leaf->b[r->kx]));
        by = fma(r->sy, bz, o_y - rt_vfloat(leaf->b[r->ky]));
        cx = fma(r->sx, cz, o_x - rt_vfloat(leaf->c[r->kx]));
        cy = fma(r->sy, cz, o_y - rt_vfloat(leaf->c[r->ky]));
    } else
#endif
    {
#define RT_ACROSS(corner, x, y)                                                                                                  \
    {                                                                                                                            \
        const vfloat kx = r->ox - rt_vfloat(leaf->corner[0]), ky = r->oy - rt_vfloat(leaf->corner[1]),                           \
                     kz = r->oz - rt_vfloat(leaf->corner[2]);                                                                    \
        x = fma(r->px, kx, fma(r->py, ky, r->pz * kz));                                                                          \
        y = fma(r->qx, kx, fma(r->qy, ky, r->qz * kz));                                                                          \
    }
        RT_ACROSS(a, ax, ay)
        RT_ACROSS(b, bx, by)
        RT_ACROSS(c, cx, cy)
#undef RT_ACROSS
    }
    const vfloat u = cx * by - cy * bx;
    const vfloat v = ax * cy - ay * cx;
    const vfloat w = bx * ay - by * ax;
    const vfloat lowest = rt_min(rt_min(u, v), w), highest = rt_max(rt_max(u, v), w);
    const vfloat zero = rt_vfloat(0.0f);
    const vmask inside = RT_MASK(lowest >= zero) | RT_MASK(highest <= zero);
    if (!rt_any(inside & RT_MASK(h->t >= zero))) return;

    const vfloat det = u + v + w, scale = rt_vfloat(1.0f) / det;
    vfloat sum;
#define RT_ALONG(corner)                                                                                                         \
    fma(r->rx, rt_vfloat(leaf->corner[0]) - r->ox,                                                                               \
        fma(r->ry, rt_vfloat(leaf->corner[1]) - r->oy, r->rz * (rt_vfloat(leaf->corner[2]) - r->oz)))
    sum = fma(u, RT_ALONG(a), fma(v, RT_ALONG(b), w * RT_ALONG(c)));
#undef RT_ALONG
    const vfloat t = sum * scale;
    const vmask closer = inside & RT_MASK(det != zero) & RT_MASK(t >= r->t_min) & RT_MASK(t < h->t);
    if (!rt_any(closer)) return;
#if RT_ANY_HIT
    h->t = rt_select(closer, rt_vfloat(-1.0f), h->t);
#else
    const float e1x = leaf->b[0] - leaf->a[0], e1y = leaf->b[1] - leaf->a[1], e1z = leaf->b[2] - leaf->a[2];
    const float e2x = leaf->c[0] - leaf->a[0], e2y = leaf->c[1] - leaf->a[1], e2z = leaf->c[2] - leaf->a[2];
    h->t = rt_select(closer, t, h->t);
    h->u = rt_select(closer, v * scale, h->u);
    h->v = rt_select(closer, w * scale, h->v);
    h->nx = rt_select(closer, rt_vfloat(e1y * e2z - e1z * e2y), h->nx);
    h->ny = rt_select(closer, rt_vfloat(e1z * e2x - e1x * e2z), h->ny);
    h->nz = rt_select(closer, rt_vfloat(e1x * e2y - e1y * e2x), h->nz);
    h->leaf = rt_select(closer, rt_vint(at), h->leaf);
    h->instance = rt_select(closer, rt_vint(-1), h->instance);
#endif
}
