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
#define RT_PROJECT(corner, x, y, z) rt_to_ray_space(r, leaf->corner, *(const global float4 *)leaf->corner, x, y, z);
#else
#define RT_CORNER(corner, k) leaf->corner.s##k
#define RT_PRIM as_uint(leaf->c.s3)
#define RT_PROJECT(corner, x, y, z) rt_to_ray_space(r, 0, leaf->corner, x, y, z);
#endif
#ifdef RT_RAYS_PER_ITEM
#define RT_PROJECT_AXIS(i, j, k)                                                                                                 \
    RT_TO_RAY_SPACE_AXIS(a, i, j, k, ax, ay, az)                                                                                       \
    RT_TO_RAY_SPACE_AXIS(b, i, j, k, bx, by, bz)                                                                                       \
    RT_TO_RAY_SPACE_AXIS(c, i, j, k, cx, cy, cz)
#define RT_PROJECT_ALL                                                                                                           \
    if (r->kz == 2u) {                                                                                                           \
        RT_PROJECT_AXIS(x, y, z)                                                                                                 \
    } else if (r->kz == 1u) {                                                                                                    \
        RT_PROJECT_AXIS(z, x, y)                                                                                                 \
    } else {                                                                                                                     \
        RT_PROJECT_AXIS(y, z, x)                                                                                                 \
    }
#else
#define RT_PROJECT_ALL                                                                                                           \
    RT_PROJECT(a, &ax, &ay, &az)                                                                                                 \
    RT_PROJECT(b, &bx, &by, &bz)                                                                                                 \
    RT_PROJECT(c, &cx, &cy, &cz)
#endif
/* Corners across the ray and what the edges say of it. */
#define RT_TRIANGLE_EDGES                                                                                                        \
    vfloat ax, ay, az, bx, by, bz, cx, cy, cz;                                                                                   \
    RT_PROJECT_ALL                                                                                                               \
    const vfloat u = cx * by - cy * bx;                                                                                          \
    const vfloat v = ax * cy - ay * cx;                                                                                          \
    const vfloat w = bx * ay - by * ax;                                                                                          \
    const vfloat zero = rt_vfloat(0.0f);                                                                                         \
    const vmask between = RT_MASK(rt_min(rt_min(u, v), w) >= zero) | RT_MASK(rt_max(rt_max(u, v), w) <= zero);

#if RT_CPU
/* Whether a lane may hit it: the first half of the test, for who asks for many before it tests those that answered. */
RT_INLINE uint RT_FN(rt_maybe_triangle)(const global rt_packed_prim *leaf, const rt_rays *r, const rt_hits *h)
{
#pragma OPENCL FP_CONTRACT OFF
    RT_TRIANGLE_EDGES
    return rt_any(between & RT_MASK(h->t >= zero)) ? 1u : 0u;
}
#endif

#if RT_CPU
RT_INLINE void RT_FN(rt_hit_triangle)(const global rt_packed_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
#else
RT_INLINE void RT_FN(rt_hit_loaded_triangle)(const rt_loaded_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
#endif
{
#pragma OPENCL FP_CONTRACT OFF
    const uint prim = RT_PRIM;
    RT_TRIANGLE_EDGES
    vmask inside = between;
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
#undef RT_PROJECT
#undef RT_PROJECT_AXIS
#undef RT_PROJECT_ALL
#undef RT_TRIANGLE_EDGES

#if !RT_CPU
RT_INLINE void RT_FN(rt_hit_triangle)(const global rt_packed_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
{
    const rt_loaded_prim loaded = rt_load_leaf(leaf);
    RT_FN(rt_hit_loaded_triangle)(&loaded, at, r, h);
}
#endif

/* A triangle whose record the traversal has fetched, of the group that is traversed. */
#if RT_LANES == 1
RT_INLINE void RT_FN(rt_loaded_prim)(const rt_ctx *ctx, const rt_loaded_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
{
    RT_COUNT_LEAF(h);
#if RT_CPU
    RT_FN(rt_hit_triangle)(ctx->leaves + at, at, r, h);
#else
    RT_FN(rt_hit_loaded_triangle)(leaf, at, r, h);
#endif
}
#endif
