/* warps.h -- maps numbers u1, u2 in [0, 1) to points and directions of a known density. Neighbours stay neighbours, so that the strata
 * of a sampler keep their worth. */
#ifndef RT_WARPS_H
#define RT_WARPS_H

/* Vectors s and t that make an orthonormal, right-handed frame with the unit vector n (Duff et al. 2017, Building an Orthonormal
 * Basis, Revisited). */
RT_INLINE void rt_basis(rt_vec n, rt_vec *s, rt_vec *t)
{
    const vfloat one = rt_vfloat(1.0f), sign = rt_select(RT_MASK(n.z < rt_vfloat(0.0f)), -one, one);
    const vfloat a = -one / (sign + n.z), b = n.x * n.y * a;
    *s = rt_vec_of(fma(sign * n.x * n.x, a, one), sign * b, -sign * n.x);
    *t = rt_vec_of(b, fma(n.y * n.y, a, sign), -n.y);
}
RT_INLINE rt_vec rt_to_local(rt_vec s, rt_vec t, rt_vec n, rt_vec v) { return rt_vec_of(rt_dot(s, v), rt_dot(t, v), rt_dot(n, v)); }
RT_INLINE rt_vec rt_to_world(rt_vec s, rt_vec t, rt_vec n, rt_vec v) { return rt_along(v.x, s, rt_along(v.y, t, rt_scale(v.z, n))); }

/* A point of the unit disc, density 1 / pi (Shirley and Chiu 1997, A Low Distortion Map Between Disk and Square). */
RT_INLINE void rt_warp_disc(vfloat u1, vfloat u2, vfloat *x, vfloat *y)
{
    const vfloat one = rt_vfloat(1.0f), a = fma(u1, rt_vfloat(2.0f), -one), b = fma(u2, rt_vfloat(2.0f), -one);
    const vmask wide = RT_MASK(fabs(a) > fabs(b));
    const vfloat radius = rt_select(wide, a, b), other = rt_select(wide, b, a);
    const vfloat eighth = rt_vfloat(0.125f) * other / rt_select(RT_MASK(radius == rt_vfloat(0.0f)), one, radius);
    vfloat sine, cosine;
    rt_sin_cos_turns(rt_select(wide, eighth, rt_vfloat(0.25f) - eighth), &sine, &cosine);
    *x = radius * cosine;
    *y = radius * sine;
}

/* A direction above z = 0, density z / pi. */
RT_INLINE rt_vec rt_warp_cosine(vfloat u1, vfloat u2)
{
    rt_vec w;
    rt_warp_disc(u1, u2, &w.x, &w.y);
    w.z = sqrt(rt_max(fma(-w.x, w.x, fma(-w.y, w.y, rt_vfloat(1.0f))), rt_vfloat(0.0f)));
    return w;
}

/* Barycentric coordinates of the second and third corner of a triangle, density 1 / area. */
RT_INLINE void rt_warp_triangle(vfloat u1, vfloat u2, vfloat *second, vfloat *third)
{
    const vfloat root = sqrt(u1);
    *second = root * (rt_vfloat(1.0f) - u2);
    *third = root * u2;
}

/* A direction within a cone about z; density 1 / (2 pi height). height: 1 - the cosine of the cone's half angle; 2 is the sphere. Thin
 * cones keep their digits because the cosine itself is not needed. */
RT_INLINE rt_vec rt_warp_cone(vfloat u1, vfloat u2, vfloat height)
{
    const vfloat below = u1 * height;
    vfloat sine, cosine;
    rt_sin_cos_turns(u2, &sine, &cosine);
    const vfloat radius = sqrt(rt_max(below * (rt_vfloat(2.0f) - below), rt_vfloat(0.0f)));
    return rt_vec_of(radius * cosine, radius * sine, rt_vfloat(1.0f) - below);
}

/* A normal of the facets of GGX that are seen from wo, wo.z > 0: density D(h) G1(wo) max(wo.h, 0) / wo.z. Where facets are stretched to
 * a hemisphere, mirrored directions fill a spherical cap (Dupuy and Benyoub 2023, Sampling Visible GGX Normals with Spherical Caps).
 * along, across: alphas along x and y. */
RT_INLINE rt_vec rt_warp_visible_normal(rt_vec wo, vfloat along, vfloat across, vfloat u1, vfloat u2)
{
    const vfloat one = rt_vfloat(1.0f);
    const rt_vec view = rt_normalize(rt_vec_of(along * wo.x, across * wo.y, wo.z));
    const vfloat z = fma(one - u1, one + view.z, -view.z);
    vfloat sine, cosine;
    rt_sin_cos_turns(u2, &sine, &cosine);
    const vfloat radius = sqrt(rt_max(fma(-z, z, one), rt_vfloat(0.0f)));
    const rt_vec h = rt_add(rt_vec_of(radius * cosine, radius * sine, z), view);
    return rt_normalize(rt_vec_of(along * h.x, across * h.y, rt_max(h.z, rt_vfloat(1e-7f))));
}

#endif
