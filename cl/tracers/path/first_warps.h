/* first_warps.h -- the local frame of a normal, and from the unit square to the unit disc. */
#ifndef RT_FIRST_WARPS_H
#define RT_FIRST_WARPS_H

/* Duff et al. 2017, Building an Orthonormal Basis, Revisited. */
RT_INLINE void rt_basis(rt_vec n, rt_vec *s, rt_vec *t)
{
    const vfloat one = rt_vfloat(1.0f), sign = copysign(one, n.z), a = -one / (sign + n.z), b = n.x * n.y * a;
    *s = rt_vec_of(fma(sign * n.x, n.x * a, one), sign * b, -sign * n.x);
    *t = rt_vec_of(b, fma(n.y, n.y * a, sign), -n.y);
}
RT_INLINE rt_vec rt_to_local(rt_vec s, rt_vec t, rt_vec n, rt_vec v) { return rt_vec_of(rt_dot(s, v), rt_dot(t, v), rt_dot(n, v)); }
RT_INLINE rt_vec rt_to_world(rt_vec s, rt_vec t, rt_vec n, rt_vec v) { return rt_along(v.x, s, rt_along(v.y, t, rt_scale(v.z, n))); }

/* Shirley, Chiu 1997, A Low Distortion Map Between Disk and Square, with polynomials for sine and cosine within an eighth of a
 * turn. */
RT_INLINE void rt_warp_disc(vfloat u1, vfloat u2, vfloat *px, vfloat *py)
{
    const vfloat one = rt_vfloat(1.0f), x = fma(rt_vfloat(2.0f), u1, -one), y = fma(rt_vfloat(2.0f), u2, -one);
    const vmask wide = RT_MASK(fabs(x) > fabs(y));
    const vfloat radius = rt_select(wide, x, y), other = rt_select(wide, y, x);
    const vfloat angle = rt_vfloat(0.78539816f) * other / rt_select(RT_MASK(radius == rt_vfloat(0.0f)), one, radius), q = angle * angle;
    const vfloat sine = angle * fma(q, fma(q, fma(q, rt_vfloat(-1.0f / 5040.0f), rt_vfloat(1.0f / 120.0f)), rt_vfloat(-1.0f / 6.0f)), one);
    const vfloat cosine = fma(q, fma(q, fma(q, rt_vfloat(-1.0f / 720.0f), rt_vfloat(1.0f / 24.0f)), rt_vfloat(-0.5f)), one);
    *px = radius * rt_select(wide, cosine, sine);
    *py = radius * rt_select(wide, sine, cosine);
}

#endif
