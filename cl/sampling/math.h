/* math.h -- sine, cosine, exponential, arc functions and the sRGB curve of all lanes.
 *
 * Plain arithmetic, so that all lane counts and devices agree; the functions of a library differ between them. The polynomials are
 * minimax fits of the functions named beside them. Errors are the largest found against a library in double precision
 * (tests/tracers/path/math_test.cpp), roundings included. */
#ifndef RT_MATH_H
#define RT_MATH_H

/* From here on a compiler may not fuse products and sums, which it does for one number of lanes and not for another. */
#pragma OPENCL FP_CONTRACT OFF

#define RT_PI 3.14159265f
#define RT_INVERSE_PI 0.318309886f
#define RT_LN_2 0.693147181f

/* Sine and cosine of quarter turns + x, x within a quarter of pi of 0. */
RT_INLINE void rt_sin_cos_of_quarters(vint quarters, vfloat x, vfloat *sine, vfloat *cosine)
{
    const vfloat z = x * x, one = rt_vfloat(1.0f);
    vfloat s = fma(z, rt_vfloat(2.718311609e-6f), rt_vfloat(-1.983933485e-4f)); /* sin x = x + x z s */
    s = fma(s, z, rt_vfloat(8.333329386e-3f));
    s = fma(s, z, rt_vfloat(-1.666666664e-1f));
    s = fma(s * z, x, x);
    vfloat c = fma(z, rt_vfloat(-2.721025112e-7f), rt_vfloat(2.479952016e-5f)); /* cos x = 1 - z / 2 + z^2 c */
    c = fma(c, z, rt_vfloat(-1.388888375e-3f));
    c = fma(c, z, rt_vfloat(4.166666662e-2f));
    c = fma(c, z, rt_vfloat(-0.5f));
    c = fma(c, z, one);
    const vmask swapped = RT_MASK((quarters & rt_vint(1)) != rt_vint(0));
    const vmask sine_negative = RT_MASK((quarters & rt_vint(2)) != rt_vint(0));
    const vmask cosine_negative = RT_MASK(((quarters + rt_vint(1)) & rt_vint(2)) != rt_vint(0));
    const vfloat first = rt_select(swapped, c, s), second = rt_select(swapped, s, c);
    *sine = rt_select(sine_negative, -first, first);
    *cosine = rt_select(cosine_negative, -second, second);
}

/* Of x in radians, |x| up to 10000: within 1.2e-7. Beyond 1e9 they have no value. */
RT_INLINE void rt_sin_cos(vfloat x, vfloat *sine, vfloat *cosine)
{
    const vfloat quarters = floor(fma(x, rt_vfloat(0.636619772f), rt_vfloat(0.5f)));
    /* pi / 2 as a float and what is missing, after Cody and Waite 1980. */
    const vfloat rest = fma(quarters, rt_vfloat(4.37113883e-8f), fma(quarters, rt_vfloat(-1.57079637f), x));
    rt_sin_cos_of_quarters(rt_to_int(quarters), rest, sine, cosine);
}

/* Of u turns, 2 pi u radians, |u| up to 1000: within 1.2e-7. */
RT_INLINE void rt_sin_cos_turns(vfloat u, vfloat *sine, vfloat *cosine)
{
    const vfloat quarters = floor(fma(u, rt_vfloat(4.0f), rt_vfloat(0.5f)));
    const vfloat rest = fma(quarters, rt_vfloat(-0.25f), u) * rt_vfloat(6.28318531f); /* the difference is exact */
    rt_sin_cos_of_quarters(rt_to_int(quarters), rest, sine, cosine);
}

/* 2^x: within 1.5e-7 of the result. 0 below -126, and what 2^127.99 is above that. */
RT_INLINE vfloat rt_exp2(vfloat x)
{
    const vfloat within = rt_min(rt_max(x, rt_vfloat(-126.0f)), rt_vfloat(127.99f));
    const vfloat whole = floor(within + rt_vfloat(0.5f)), f = within - whole;
    vfloat p = fma(f, rt_vfloat(1.547630006e-4f), rt_vfloat(1.340026970e-3f)); /* 2^f = 1 + f p */
    p = fma(p, f, rt_vfloat(9.618003890e-3f));
    p = fma(p, f, rt_vfloat(5.550327791e-2f));
    p = fma(p, f, rt_vfloat(2.402265135e-1f));
    p = fma(p, f, rt_vfloat(6.931472062e-1f));
    p = fma(p, f, rt_vfloat(1.0f));
    /* In two steps, since 2^128 is no float. */
    const vint exponent = rt_to_int(whole), first = exponent >> 1;
    p = p * rt_as_vfloat((first + rt_vint(127)) << 23) * rt_as_vfloat((exponent - first + rt_vint(127)) << 23);
    return rt_select(RT_MASK(x < rt_vfloat(-126.0f)), rt_vfloat(0.0f), p);
}

/* e^x: within 2.5e-7 of the result for x in -10 to 10, 1e-7 (1 + |x|) beyond; 0 below -87.3. */
RT_INLINE vfloat rt_exp(vfloat x)
{
    /* x / ln 2 in a rounded part and its rest, so that a large x keeps its digits. */
    const vfloat inverse = rt_vfloat(1.44269502f), y = x * inverse;
    const vfloat rest = fma(x, rt_vfloat(1.92596303e-8f), fma(x, inverse, -y));
    const vfloat power = rt_exp2(y);
    return fma(power * rest, rt_vfloat(RT_LN_2), power);
}

/* The angle of (x, y) from the x axis, -pi to pi: within 4e-7. 0 for (0, 0); y = -0 counts as 0. */
RT_INLINE vfloat rt_atan2(vfloat y, vfloat x)
{
    const vfloat zero = rt_vfloat(0.0f), ax = fabs(x), ay = fabs(y);
    const vmask steep = RT_MASK(ay > ax);
    const vfloat large = rt_select(steep, ay, ax), small = rt_select(steep, ax, ay);
    const vfloat t = rt_select(RT_MASK(large > zero), small / rt_max(large, rt_vfloat(1e-37f)), zero), z = t * t;
    vfloat p = fma(z, rt_vfloat(2.974586553e-3f), rt_vfloat(-1.658116883e-2f)); /* atan t = t + t z p */
    p = fma(p, z, rt_vfloat(4.355351509e-2f));
    p = fma(p, z, rt_vfloat(-7.580576117e-2f));
    p = fma(p, z, rt_vfloat(1.067893936e-1f));
    p = fma(p, z, rt_vfloat(-1.421420891e-1f));
    p = fma(p, z, rt_vfloat(1.999413718e-1f));
    p = fma(p, z, rt_vfloat(-3.333316696e-1f));
    vfloat angle = fma(p * z, t, t);
    angle = rt_select(steep, rt_vfloat(0.5f * RT_PI) - angle, angle);
    angle = rt_select(RT_MASK(x < zero), rt_vfloat(RT_PI) - angle, angle);
    return rt_select(RT_MASK(y < zero), -angle, angle);
}

/* Within 4e-7, for x in -1 to 1; beyond as at the nearer end. */
RT_INLINE vfloat rt_acos(vfloat x)
{
    const vfloat one = rt_vfloat(1.0f), a = rt_min(fabs(x), one);
    vfloat p = fma(a, rt_vfloat(-1.440934314e-3f), rt_vfloat(7.243790274e-3f)); /* acos a = sqrt(1 - a) p */
    p = fma(p, a, rt_vfloat(-1.780702962e-2f));
    p = fma(p, a, rt_vfloat(3.133434425e-2f));
    p = fma(p, a, rt_vfloat(-5.031245727e-2f));
    p = fma(p, a, rt_vfloat(8.899922057e-2f));
    p = fma(p, a, rt_vfloat(-2.145998903e-1f));
    p = fma(p, a, rt_vfloat(1.570796314f));
    const vfloat angle = p * sqrt(one - a);
    return rt_select(RT_MASK(x < rt_vfloat(0.0f)), rt_vfloat(RT_PI) - angle, angle);
}

/* sRGB to linear by the curve of IEC 61966-2-1, for 0 to 1: within 5e-7. The power 2.4 is a polynomial of t, which goes from -1 at
 * the end of the straight part to 1. */
RT_INLINE vfloat rt_srgb_to_linear(vfloat c)
{
    const vfloat t = fma(c, rt_vfloat(2.0f / 0.95955f), rt_vfloat(-1.04045f / 0.95955f));
    vfloat p = fma(t, rt_vfloat(1.445512647e-4f), rt_vfloat(-1.948862564e-4f));
    p = fma(p, t, rt_vfloat(2.718757934e-6f));
    p = fma(p, t, rt_vfloat(-2.340975841e-4f));
    p = fma(p, t, rt_vfloat(1.099713376e-3f));
    p = fma(p, t, rt_vfloat(-3.845691699e-3f));
    p = fma(p, t, rt_vfloat(3.029505950e-2f));
    p = fma(p, t, rt_vfloat(2.725995292e-1f));
    p = fma(p, t, rt_vfloat(4.668925535e-1f));
    p = fma(p, t, rt_vfloat(2.332407464e-1f));
    return rt_select(RT_MASK(c <= rt_vfloat(0.04045f)), c * rt_vfloat(1.0f / 12.92f), p);
}

#endif
