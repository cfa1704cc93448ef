/* sheen.h -- fibres on top of a surface, as of velvet, for the path tracer.
 *
 * KHR_materials_sheen, after Estevez and Kulla 2017, Production Friendly Microfacet Sheen BRDF. Below a roughness of 0.3 its fibres would
 * send back more light than they get; they are scaled by rt_sheen_kept, which the table's maker explains (scripts/albedo_tables). */
#ifndef RT_SHEEN_H
#define RT_SHEEN_H
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)

#define RT_SHEEN_COSINES 24
#define RT_SHEEN_ROUGHNESSES 32
#define RT_LEAST_SHEEN 0.1f /* fibres of a smaller roughness have this one */

/* The share of the light from a direction of cosine mu that white fibres send back, with its mean and deviation over the hemisphere. */
RT_CALLED vfloat rt_sheen_albedo(vfloat mu, vfloat roughness)
{
    const rt_between c = rt_between_nodes(sqrt(mu), RT_SHEEN_COSINES), r = rt_between_nodes(roughness, RT_SHEEN_ROUGHNESSES);
    const vint first = c.low * rt_vint(RT_SHEEN_ROUGHNESSES) + r.low;
    return rt_mix(rt_from_pair(rt_albedo_sheen, first, r.share), rt_from_pair(rt_albedo_sheen, first + rt_vint(RT_SHEEN_ROUGHNESSES), r.share),
                  c.share);
}
RT_INLINE vfloat rt_sheen_albedo_mean(vfloat roughness)
{
    const rt_between r = rt_between_nodes(roughness, 2 * RT_SHEEN_ROUGHNESSES - 1);
    return rt_from_pair(rt_albedo_sheen_mean, r.low, r.share);
}

RT_INLINE vfloat rt_sheen_albedo_deviation(vfloat roughness)
{
    const rt_between r = rt_between_nodes(roughness, RT_SHEEN_ROUGHNESSES);
    return rt_from_pair(rt_albedo_sheen_deviation, r.low, r.share);
}

/* Lambda of Smith, a fit of Estevez and Kulla. t: (1 - alpha)^2. */
RT_INLINE vfloat rt_sheen_smith(vfloat mu, vfloat t)
{
    const vfloat half_way = rt_vfloat(0.5f), one = rt_vfloat(1.0f);
    const vfloat a = rt_mix(rt_vfloat(21.5473f), rt_vfloat(25.3245f), t), b = rt_mix(rt_vfloat(3.82987f), rt_vfloat(3.32435f), t);
    const vfloat c = rt_mix(rt_vfloat(0.19823f), rt_vfloat(0.16801f), t), d = rt_mix(rt_vfloat(-1.97760f), rt_vfloat(-1.27393f), t);
    const vfloat e = rt_mix(rt_vfloat(-4.32054f), rt_vfloat(-4.85967f), t);
    const vmask steep = RT_MASK(mu < half_way);
    const vfloat x = rt_select(steep, mu, one - mu);
    const vfloat power = a / fma(b, rt_power(x, c), one) + fma(d, x, e);
    const vfloat middle = a / fma(b, rt_power(half_way, c), one) + fma(d, half_way, e);
    return rt_exp(rt_select(steep, power, middle + middle - power));
}

/* f cos wi of white fibres; wo.z, wi.z > 0. */
RT_CALLED vfloat rt_sheen_value(rt_vec wo, rt_vec wi, vfloat roughness)
{
    const vfloat one = rt_vfloat(1.0f), least = rt_max(roughness, rt_vfloat(RT_LEAST_SHEEN)), alpha = least * least;
    const rt_vec h = rt_normalize(rt_add(wo, wi));
    const vfloat across = rt_max(fma(h.x, h.x, h.y * h.y), rt_vfloat(0.0f));
    const vfloat inverse = one / alpha, t = (one - alpha) * (one - alpha);
    const vfloat facing = (rt_vfloat(2.0f) + inverse) * rt_power(rt_min(across, one), rt_vfloat(0.5f) * inverse) * rt_vfloat(0.5f * RT_INVERSE_PI);
    const vfloat shadow = one + rt_sheen_smith(wo.z, t) + rt_sheen_smith(wi.z, t);
    const rt_between r = rt_between_nodes(roughness, RT_SHEEN_ROUGHNESSES);
    return rt_from_pair(rt_sheen_kept, r.low, r.share) * facing / (shadow * rt_vfloat(4.0f) * rt_max(wo.z, rt_vfloat(1e-6f)));
}

#endif
#endif
