/* power.h -- powers of all lanes. */
#ifndef RT_POWER_H
#define RT_POWER_H

/* x^y for x in [0,1], y > 0, as exp2(y log2 x) by polynomials: 1e-3 relative at y = 100. Plain arithmetic, so that all lane
 * counts and devices agree; a library's pow would differ between them. */
RT_INLINE vfloat rt_power(vfloat x, vfloat y)
{
    const vint xi = rt_as_vint(rt_max(x, rt_vfloat(1e-20f)));
    const vint e = (xi >> 23) - 127;
    const vfloat m = rt_as_vfloat((xi & 0x007fffff) | 0x3f800000); /* 1..2 */
    /* log2(m) = 2/ln2 (z + z^3/3 + z^5/5 + ..), z = (m-1)/(m+1) <= 1/3 */
    const vfloat z = (m - 1.0f) / (m + 1.0f), z2 = z * z;
    vfloat series = rt_vfloat(0.32059889f);
    series = fma(series, z2, rt_vfloat(0.41219858f));
    series = fma(series, z2, rt_vfloat(0.57707802f));
    series = fma(series, z2, rt_vfloat(0.96179669f));
    series = fma(series, z2, rt_vfloat(2.8853901f));
    const vfloat l = rt_max(y * fma(z, series, rt_to_float(e)), rt_vfloat(-126.0f));
    const vfloat whole = floor(l), f = l - whole;
    vfloat power = rt_vfloat(0.0013333558f); /* 2^f by its Taylor series, f in 0..1 */
    power = fma(power, f, rt_vfloat(0.0096181291f));
    power = fma(power, f, rt_vfloat(0.055504109f));
    power = fma(power, f, rt_vfloat(0.24022651f));
    power = fma(power, f, rt_vfloat(0.69314718f));
    power = fma(power, f, rt_vfloat(1.0f));
    return power * rt_as_vfloat((rt_to_int(whole) + 127) << 23);
}

#endif
