/* first_warps.h -- from the unit square to the unit disc. */
#ifndef RT_FIRST_WARPS_H
#define RT_FIRST_WARPS_H

/* Shirley, Chiu 1997, A Low Distortion Map Between Disk and Square, with polynomials for sine and cosine within an eighth of a
 * turn. */
RT_INLINE void rt_disc_point(vfloat u1, vfloat u2, vfloat *px, vfloat *py)
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
