/* film.h -- a film of the thickness of a wave of light on a surface, for the path tracer.
 *
 * KHR_materials_iridescence, after Belcour and Barla 2017, A Practical Extension to Microfacet Theory for the Modeling of Varying
 * Iridescence: the first two orders of what comes back from the surface below, and the eye's sensitivities as Gaussians of the path's
 * length. A shift of the phase is 0 or half a wave, so it is a sign. */
#ifndef RT_FILM_H
#define RT_FILM_H
#if RT_MAY_SCATTER(RT_LOBE_FILM)

/* How eyes see cos(2 pi length / wavelength) on average, in linear Rec. 709. length: in m, times 2 pi. */
RT_INLINE rt_vec rt_seen_wave(vfloat length)
{
    const vfloat squared = -length * length;
    const float middles[4] = {1.6810e6f, 1.7953e6f, 2.2084e6f, 2.2399e6f}, widths[4] = {4.3278e9f, 9.3046e9f, 6.6121e9f, 4.5282e9f};
    const float heights[4] = {0.846590f, 1.000222f, 1.001122f, 0.153868f};
    vfloat seen[4];
    for (int k = 0; k < 4; ++k) {
        vfloat sine, cosine;
        rt_sin_cos(length * rt_vfloat(middles[k]), &sine, &cosine);
        seen[k] = rt_vfloat(heights[k]) * cosine * rt_exp(squared * rt_vfloat(widths[k]));
    }
    const vfloat x = seen[0] + seen[3], y = seen[1], z = seen[2];
    return rt_vec_of(fma(x, rt_vfloat(3.2404542f), fma(y, rt_vfloat(-1.5371385f), z * rt_vfloat(-0.4985314f))),
                     fma(x, rt_vfloat(-0.9692660f), fma(y, rt_vfloat(1.8760108f), z * rt_vfloat(0.0415560f))),
                     fma(x, rt_vfloat(0.0556434f), fma(y, rt_vfloat(-0.2040259f), z * rt_vfloat(1.0572252f))));
}

/* One channel. above, below: reflectances of the film's two sides; first, second: rt_seen_wave() of one and two ways through it. */
RT_INLINE vfloat rt_film_channel(vfloat above, vfloat below, vfloat first, vfloat second)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), through = one - above;
    const vfloat both = rt_min(rt_max(above * below, rt_vfloat(1e-5f)), rt_vfloat(0.9999f)), root = sqrt(both);
    const vfloat back = through * through * below / (one - both), wave = (back - through) * root;
    const vfloat sum = fma(rt_vfloat(2.0f) * wave, fma(root, second, first), above + back);
    return rt_min(rt_max(sum, zero), one);
}

/* The reflectance of a surface that has `straight` without the film. cosine: outside. nm: thickness. */
RT_CALLED rt_vec rt_film(vfloat cosine, vfloat film_ior, vfloat nm, rt_vec straight)
{
    const vfloat one = rt_vfloat(1.0f), t = rt_min(nm * rt_vfloat(1.0f / 0.03f), one);
    /* No film has no effect. */
    const vfloat ior = rt_mix(one, film_ior, t * t * fma(rt_vfloat(-2.0f), t, rt_vfloat(3.0f)));
    const vfloat inside2 = one - rt_max(one - cosine * cosine, rt_vfloat(0.0f)) / (ior * ior), inside = sqrt(rt_max(inside2, rt_vfloat(0.0f)));
    const vfloat mirrored = (ior - one) / (ior + one), above = rt_mix(mirrored * mirrored, one, rt_schlick_weight(cosine));
    const vfloat length = rt_vfloat(2.0f * 2.0f * RT_PI * 1e-9f) * ior * nm * inside;
    const rt_vec first = rt_seen_wave(length), second = rt_seen_wave(length + length);
    vfloat channels[3] = {straight.x, straight.y, straight.z};
    const vfloat firsts[3] = {first.x, first.y, first.z}, seconds[3] = {second.x, second.y, second.z};
    for (int k = 0; k < 3; ++k) {
        const vfloat root = sqrt(rt_min(rt_max(channels[k], rt_vfloat(0.0f)), rt_vfloat(0.9999f))), base = (one + root) / (one - root);
        const vfloat met = (base - ior) / (base + ior), below = rt_mix(met * met, one, rt_schlick_weight(inside));
        /* Light that meets what is denser turns by half a wave. */
        const vmask turned = RT_MASK(ior < one) ^ RT_MASK(base < ior);
        channels[k] = rt_film_channel(above, below, rt_select(turned, firsts[k], -firsts[k]), seconds[k]);
    }
    const vmask total = RT_MASK(inside2 <= rt_vfloat(0.0f));
    return rt_choose(total, rt_vec_of(one, one, one), rt_vec_of(channels[0], channels[1], channels[2]));
}

#endif
#endif
