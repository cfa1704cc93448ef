/* triangle.h -- watertight ray/triangle test on lanes.
 *
 * Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection". Corners are projected across the ray by a map that is the
 * same for every triangle, then three 2D edge functions decide. Each is a difference of two rounded products, never fused:
 * rounding is monotone, so its sign is right or it is zero, and the two triangles at an edge compute it from the same numbers.
 * A zero counts as inside, so no ray passes between triangles that share corners; Woop's double-precision fallback would only
 * decide which of the two gets it. */
#if RT_CPU
#define RT_CORNER(corner, k) leaf->corner[k]
#define RT_PRIM leaf->prim
RT_INLINE void RT_FN(rt_hit_triangle)(const global rt_leaf *leaf, uint at, const rt_rays *r, rt_hits *h)
#else
#define RT_CORNER(corner, k) leaf->corner.s##k
#define RT_PRIM as_uint(leaf->c.s3)
RT_INLINE void RT_FN(rt_hit_loaded_triangle)(const rt_loaded_leaf *leaf, uint at, const rt_rays *r, rt_hits *h)
#endif
{
#pragma OPENCL FP_CONTRACT OFF
    const uint prim = RT_PRIM;
    /* Corners across the ray (x, y) and along it (z, in units of the dominant axis), from corner to origin: the sign of the edge
     * functions does not mind, and o - corner takes the corner straight from memory. */
    vfloat ax, ay, az, bx, by, bz, cx, cy, cz;
#if RT_CPU
    if (r->same_axis) {
        const vfloat o_x = r->kz == 2u ? r->ox : r->kz == 1u ? r->oz : r->oy;
        const vfloat o_y = r->kz == 2u ? r->oy : r->kz == 1u ? r->ox : r->oz;
        const vfloat o_z = r->kz == 2u ? r->oz : r->kz == 1u ? r->oy : r->ox;
        az = o_z - rt_vfloat(leaf->a[r->kz]);
        bz = o_z - rt_vfloat(leaf->b[r->kz]);
        cz = o_z - rt_vfloat(leaf->c[r->kz]);
        ax = fma(r->sx, az, o_x - rt_vfloat(leaf->a[r->kx]));
        ay = fma(r->sy, az, o_y - rt_vfloat(leaf->a[r->ky]));
        bx = fma(r->sx, bz, o_x - rt_vfloat(leaf->b[r->kx]));
        by = fma(r->sy, bz, o_y - rt_vfloat(leaf->b[r->ky]));
        cx = fma(r->sx, cz, o_x - rt_vfloat(leaf->c[r->kx]));
        cy = fma(r->sy, cz, o_y - rt_vfloat(leaf->c[r->ky]));
    } else /* the same numbers, lane by lane: a ray's hit does not depend on who travels with it */
#endif
    {
#define RT_ACROSS(corner, x, y, z)                                                                                               \
    {                                                                                                                            \
        const vfloat from_x = r->ox - rt_vfloat(RT_CORNER(corner, 0)), from_y = r->oy - rt_vfloat(RT_CORNER(corner, 1)),         \
                     from_z = r->oz - rt_vfloat(RT_CORNER(corner, 2));                                                           \
        z = rt_select(r->is_z, from_z, rt_select(r->is_y, from_y, from_x));                                                      \
        x = fma(r->sx, z, rt_select(r->is_z, from_x, rt_select(r->is_y, from_z, from_y)));                                       \
        y = fma(r->sy, z, rt_select(r->is_z, from_y, rt_select(r->is_y, from_x, from_z)));                                       \
    }
        RT_ACROSS(a, ax, ay, az)
        RT_ACROSS(b, bx, by, bz)
        RT_ACROSS(c, cx, cy, cz)
#undef RT_ACROSS
    }
    const vfloat u = cx * by - cy * bx;
    const vfloat v = ax * cy - ay * cx;
    const vfloat w = bx * ay - by * ax;
    const vfloat lowest = rt_min(rt_min(u, v), w), highest = rt_max(rt_max(u, v), w);
    const vfloat zero = rt_vfloat(0.0f);
    vmask inside = RT_MASK(lowest >= zero) | RT_MASK(highest <= zero);
    if (!rt_any(inside & RT_MASK(h->t >= zero))) return;
    /* A ray that passes a slim triangle at a million times its size finds all three products equal by rounding. The ray is the
     * origin here, so a triangle around it has corners on both sides of either axis: exact, and so still watertight. */
    inside &= RT_MASK(rt_min(rt_min(ax, bx), cx) <= zero) & RT_MASK(rt_max(rt_max(ax, bx), cx) >= zero) &
              RT_MASK(rt_min(rt_min(ay, by), cy) <= zero) & RT_MASK(rt_max(rt_max(ay, by), cy) >= zero);

    /* t by the triangle's plane: weighing the corners with u, v, w cancels where they are far away, as a floor's are. Seen
     * edge-on the plane says nothing, so t is kept within the corners'. */
    const float e1x = RT_CORNER(b, 0) - RT_CORNER(a, 0), e1y = RT_CORNER(b, 1) - RT_CORNER(a, 1), e1z = RT_CORNER(b, 2) - RT_CORNER(a, 2);
    const float e2x = RT_CORNER(c, 0) - RT_CORNER(a, 0), e2y = RT_CORNER(c, 1) - RT_CORNER(a, 1), e2z = RT_CORNER(c, 2) - RT_CORNER(a, 2);
    const float nx = e1y * e2z - e1z * e2y, ny = e1z * e2x - e1x * e2z, nz = e1x * e2y - e1y * e2x;
    const vfloat facing = fma(rt_vfloat(nx), r->dx, fma(rt_vfloat(ny), r->dy, rt_vfloat(nz) * r->dz));
    const vfloat height = fma(rt_vfloat(nx), rt_vfloat(RT_CORNER(a, 0)) - r->ox,
                              fma(rt_vfloat(ny), rt_vfloat(RT_CORNER(a, 1)) - r->oy, rt_vfloat(nz) * (rt_vfloat(RT_CORNER(a, 2)) - r->oz)));
    const vfloat ta = -az * r->sz, tb = -bz * r->sz, tc = -cz * r->sz;
    const vfloat t = rt_min(rt_max(height / facing, rt_min(rt_min(ta, tb), tc)), rt_max(rt_max(ta, tb), tc));
    const vfloat det = u + v + w, scale = rt_vfloat(1.0f) / det;
    const vmask closer = inside & RT_MASK(det != zero) & rt_closer(r, h, t, prim);
    if (!rt_any(closer)) return;
    RT_FN(rt_record)(h, closer, t, v * scale, w * scale, rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), (int)at, prim);
}
#undef RT_CORNER
#undef RT_PRIM

#if !RT_CPU
RT_INLINE void RT_FN(rt_hit_triangle)(const global rt_leaf *leaf, uint at, const rt_rays *r, rt_hits *h)
{
    const rt_loaded_leaf loaded = rt_load_leaf(leaf);
    RT_FN(rt_hit_loaded_triangle)(&loaded, at, r, h);
}
#endif

/* A triangle whose record the traversal has fetched, of the group that is traversed. */
#if RT_LANES == 1
RT_INLINE void RT_FN(rt_loaded_leaf)(const rt_ctx *ctx, const rt_loaded_leaf *leaf, uint at, const rt_rays *r, rt_hits *h)
{
    RT_COUNT_LEAF(h);
#if RT_CPU
    RT_FN(rt_hit_triangle)(ctx->leaves + at, at, r, h);
#else
    RT_FN(rt_hit_loaded_triangle)(leaf, at, r, h);
#endif
}
#endif
