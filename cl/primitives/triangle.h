/* triangle.h -- watertight ray/triangle test on lanes.
 *
 * Woop, Benthin, Wald 2013, "Watertight Ray/Triangle Intersection". Corners are taken to ray space (ray_space.h), where three
 * edge functions decide. The two triangles at an edge compute its edge function from the same numbers. A zero counts as inside,
 * so no ray passes between triangles that share corners. Woop's double-precision fallback would only decide which of the two is
 * hit. A template, see CONTRACT.md. */
#if RT_CPU
#define RT_CORNER(corner, k) leaf->corner[k]
#define RT_PRIM leaf->prim
#else
#define RT_CORNER(corner, k) leaf->corner.s##k
#define RT_PRIM as_uint(leaf->c.s3)
#endif
#if RT_CPU
/* One branch for three corners: of one branch for each LLVM 18 keeps all three. */
#define RT_PROJECT_ALL                                                                                                         \
    if (r->same_axis) {                                                                                                        \
        rt_to_ray_space_of_one_axis(r, leaf->a, &ax, &ay, &az);                                                                \
        rt_to_ray_space_of_one_axis(r, leaf->b, &bx, &by, &bz);                                                                \
        rt_to_ray_space_of_one_axis(r, leaf->c, &cx, &cy, &cz);                                                                \
    } else {                                                                                                                   \
        rt_to_ray_space_of_axes(r, *(const global float4 *)leaf->a, &ax, &ay, &az);                                            \
        rt_to_ray_space_of_axes(r, *(const global float4 *)leaf->b, &bx, &by, &bz);                                            \
        rt_to_ray_space_of_axes(r, *(const global float4 *)leaf->c, &cx, &cy, &cz);                                            \
    }
#elif defined(RT_RAYS_PER_ITEM)
#define RT_PROJECT_AXIS(i, j, k)                                                                                               \
    RT_TO_RAY_SPACE_AXIS(a, i, j, k, ax, ay, az)                                                                               \
    RT_TO_RAY_SPACE_AXIS(b, i, j, k, bx, by, bz)                                                                               \
    RT_TO_RAY_SPACE_AXIS(c, i, j, k, cx, cy, cz)
#define RT_PROJECT_ALL                                                                                                         \
    if (r->kz == 2u) {                                                                                                         \
        RT_PROJECT_AXIS(x, y, z)                                                                                               \
    } else if (r->kz == 1u) {                                                                                                  \
        RT_PROJECT_AXIS(z, x, y)                                                                                               \
    } else {                                                                                                                   \
        RT_PROJECT_AXIS(y, z, x)                                                                                               \
    }
#else
#define RT_PROJECT_ALL                                                                                                         \
    rt_to_ray_space(r, 0, leaf->a, &ax, &ay, &az);                                                                             \
    rt_to_ray_space(r, 0, leaf->b, &bx, &by, &bz);                                                                             \
    rt_to_ray_space(r, 0, leaf->c, &cx, &cy, &cz);
#endif
/* Declares the corners in ray space, the edge functions u, v, w, and the lanes `between` that pass all edges on one side. */
#define RT_TRIANGLE_EDGES                                                                                                      \
    vfloat ax, ay, az, bx, by, bz, cx, cy, cz;                                                                                 \
    RT_PROJECT_ALL                                                                                                             \
    const vfloat u = RT_EDGE(cx, cy, bx, by);                                                                                  \
    const vfloat v = RT_EDGE(ax, ay, cx, cy);                                                                                  \
    const vfloat w = RT_EDGE(bx, by, ax, ay);                                                                                  \
    const vfloat zero = rt_vfloat(0.0f);                                                                                       \
    const vmask between = RT_MASK(RT_MIN3(u, v, w) >= zero) | RT_MASK(RT_MAX3(u, v, w) <= zero);

#if RT_CPU
/* The first half of the test: 1 if a lane may hit the triangle, else 0. For traversals that ask about many before they test
 * those. */
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
    /* A ray that passes a slim triangle at a million times its size may find all three products equal by rounding. The ray is
     * the origin here, so a triangle around it has corners on both sides of either axis. This is exact, and so still
     * watertight. */
    inside &= RT_MASK(RT_MIN3(ax, bx, cx) <= zero) & RT_MASK(RT_MAX3(ax, bx, cx) >= zero) & RT_MASK(RT_MIN3(ay, by, cy) <= zero) &
              RT_MASK(RT_MAX3(ay, by, cy) >= zero);

    float nx, ny, nz;
    rt_triangle_normal(RT_CORNER(a, 0), RT_CORNER(a, 1), RT_CORNER(a, 2), RT_CORNER(b, 0), RT_CORNER(b, 1), RT_CORNER(b, 2),
                       RT_CORNER(c, 0), RT_CORNER(c, 1), RT_CORNER(c, 2), &nx, &ny, &nz);
    const vfloat facing = RT_DOT(rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), r->dx, r->dy, r->dz);
    const vfloat height = RT_DOT(rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), rt_vfloat(RT_CORNER(a, 0)) - r->ox,
                                 rt_vfloat(RT_CORNER(a, 1)) - r->oy, rt_vfloat(RT_CORNER(a, 2)) - r->oz);
    const vfloat ta = -az * r->sz, tb = -bz * r->sz, tc = -cz * r->sz;
    const vfloat t = RT_PLANE_DISTANCE(height, facing, RT_MIN3(ta, tb, tc), RT_MAX3(ta, tb, tc));
    const vfloat det = u + v + w, scale = rt_vfloat(1.0f) / det;
    const vmask closer = inside & RT_MASK(det != zero) & rt_closer(r, h, t, prim);
    if (!rt_any(closer)) return;
    RT_FN(rt_record)(h, closer, t, v * scale, w * scale, rt_vfloat(nx), rt_vfloat(ny), rt_vfloat(nz), (int)at, prim);
}
#undef RT_CORNER
#undef RT_PRIM
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

/* RT_LOADED_PRIM: tests a triangle of the group that is traversed. The traversal has loaded the triangle's record. */
#if RT_LANES == 1
RT_INLINE void RT_FN(rt_loaded_prim)(const rt_ctx *ctx, const rt_loaded_prim *leaf, uint at, const rt_rays *r, rt_hits *h)
{
    RT_HOST_COUNT(r, tests, 1u);
#if RT_CPU
    RT_FN(rt_hit_triangle)(ctx->leaves + at, at, r, h);
#else
    RT_FN(rt_hit_loaded_triangle)(leaf, at, r, h);
#endif
}
#endif
