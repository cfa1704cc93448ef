/* microfacets.h -- rough surfaces: the GGX distribution of facets, their shadows, and what is lost when light may meet them once only.
 *
 * Walter et al. 2007, Microfacet Models for Refraction through Rough Surfaces; Heitz 2014, Understanding the Masking-Shadowing
 * Function; Kulla and Conty 2017, Revisiting Physically Based Shading at Imageworks. alpha is the roughness squared. */
#ifndef RT_MICROFACETS_H
#define RT_MICROFACETS_H

/* The nodes of the tables lost_*.h, as scripts/albedo_tables has them. */
#define RT_METAL_COSINES 32
#define RT_METAL_ROUGHNESSES 32
#define RT_GLASS_COSINES 24
#define RT_GLASS_ROUGHNESSES 18
#define RT_GLASS_IORS 14
#define RT_LOST_MEAN_SCALE 8.0f

/* Facets below this alpha are as good as none, and floats do not tell their normals apart. */
#define RT_LEAST_ALPHA 1e-4f

/* D of the facets whose normal is along h, a vector of any length. */
RT_INLINE vfloat rt_facets_along(rt_vec h, vfloat alpha)
{
    const vfloat alpha2 = alpha * alpha, across = fma(h.x, h.x, h.y * h.y);
    const vfloat t = (across / alpha2 + h.z * h.z) / rt_max(fma(h.z, h.z, across), rt_vfloat(1e-36f));
    return rt_vfloat(RT_INVERSE_PI) / (alpha2 * t * t);
}

/* 1 + 2 Lambda of Smith for a direction of cosine mu. The facets that are seen from there: G1 = 2 / (1 + smith). Seen and lit on one
 * side, their heights the same: G2 = 2 / (smith + smith'). */
RT_INLINE vfloat rt_smith(vfloat mu, vfloat alpha)
{
    const vfloat one = rt_vfloat(1.0f), mu2 = rt_max(mu * mu, rt_vfloat(1e-12f));
    return sqrt(fma(alpha * alpha, rt_max(one - mu2, rt_vfloat(0.0f)) / mu2, one));
}

/* Fresnel's reflectance for unpolarised light. eta: ior of the other side / ior of this side. *cos_out: cosine of the refracted ray,
 * 0 where all is reflected. */
RT_INLINE vfloat rt_fresnel_dielectric(vfloat cos_in, vfloat eta, vfloat *cos_out)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const vfloat cos2_out = one - (one - cos_in * cos_in) / (eta * eta);
    *cos_out = sqrt(rt_max(cos2_out, zero));
    const vfloat across = (cos_in - eta * *cos_out) / (cos_in + eta * *cos_out);
    const vfloat along = (eta * cos_in - *cos_out) / (eta * cos_in + *cos_out);
    return rt_select(RT_MASK(cos2_out <= zero), one, rt_vfloat(0.5f) * fma(across, across, along * along));
}

/* Schlick 1994: a metal that reflects `color` along its normal. */
RT_INLINE rt_vec rt_fresnel_metal(rt_vec color, vfloat cos_in)
{
    const vfloat one = rt_vfloat(1.0f), c = rt_max(one - cos_in, rt_vfloat(0.0f)), c2 = c * c, c5 = c2 * c2 * c;
    return rt_vec_of(fma(one - color.x, c5, color.x), fma(one - color.y, c5, color.y), fma(one - color.z, c5, color.z));
}

/* Where a lookup is between the nodes of a table's axis. */
typedef struct rt_between {
    vint low;
    vfloat share; /* of the next node */
} rt_between;
RT_INLINE rt_between rt_between_nodes(vfloat x, int nodes)
{
    rt_between b;
    const vfloat at = rt_min(rt_max(x, rt_vfloat(0.0f)), rt_vfloat(1.0f)) * rt_vfloat((float)(nodes - 1));
    b.low = min(rt_to_int(at), rt_vint(nodes - 2));
    b.share = at - rt_to_float(b.low);
    return b;
}

/* The number between the nodes `index` and `index` + 1, 0 to 1; of `other` in the lanes of a mask. */
RT_INLINE vfloat rt_from_either(const constant ushort *table, const constant ushort *other, vmask from_other, vint index, vfloat share)
{
    int at[RT_LANES], pick[RT_LANES];
    float low[RT_LANES], high[RT_LANES];
    rt_store(index, at);
    rt_store(from_other, pick);
    for (uint l = 0; l < RT_LANES; ++l) {
        const constant ushort *numbers = (pick[l] != 0 ? other : table) + at[l];
        low[l] = (float)numbers[0];
        high[l] = (float)numbers[1];
    }
    return fma(share, rt_load(high) - rt_load(low), rt_load(low)) * rt_vfloat(1.0f / 65535.0f);
}
RT_INLINE vfloat rt_from_pair(const constant ushort *table, vint index, vfloat share)
{
    return rt_from_either(table, table, rt_vint(0), index, share);
}
RT_INLINE vfloat rt_mix(vfloat a, vfloat b, vfloat share) { return fma(share, b - a, a); }

/* The tables' axis along the cosine: where alpha is small, the loss depends on mu / alpha. */
RT_INLINE vfloat rt_facet_axis(vfloat mu, vfloat alpha) { return sqrt(mu * (rt_vfloat(1.0f) + alpha) / (mu + alpha)); }

#if RT_MAY_SCATTER(RT_LOBE_METAL | RT_LOBE_LAYERS)
/* The share of the light from a direction of cosine mu that a metal with F = 1 loses when light meets one facet only. */
RT_CALLED vfloat rt_lost_by_metal(vfloat mu, vfloat alpha)
{
    const rt_between c = rt_between_nodes(rt_facet_axis(mu, alpha), RT_METAL_COSINES), r = rt_between_nodes(sqrt(alpha), RT_METAL_ROUGHNESSES);
    const vint first = c.low * rt_vint(RT_METAL_ROUGHNESSES) + r.low;
    return rt_mix(rt_from_pair(rt_lost_metal, first, r.share),
                  rt_from_pair(rt_lost_metal, first + rt_vint(RT_METAL_ROUGHNESSES), r.share), c.share);
}
/* Its mean over the hemisphere. */
RT_CALLED vfloat rt_lost_by_metal_mean(vfloat alpha)
{
    const rt_between r = rt_between_nodes(sqrt(alpha), 2 * RT_METAL_ROUGHNESSES - 1);
    return rt_vfloat(RT_LOST_MEAN_SCALE) * alpha * sqrt(alpha) * rt_from_pair(rt_lost_metal_mean, r.low, r.share);
}

#endif
#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
/* The tables' axis along the ior n: the root of (n - 1) / (n + 1), 1 at an ior of 10. eta may be n or 1 / n. */
RT_INLINE rt_between rt_ior_nodes(vfloat eta)
{
    const vfloat one = rt_vfloat(1.0f);
    return rt_between_nodes(sqrt(fabs(eta - one) / (eta + one) * rt_vfloat(1.0f / 0.82f)), RT_GLASS_IORS);
}

/* As rt_lost_by_metal(), of a dielectric; what it lets through is not lost. eta: ior of the other side / ior of mu's side. */
RT_CALLED vfloat rt_lost_by_glass(vfloat mu, vfloat alpha, vfloat eta)
{
    const vmask inside = RT_MASK(eta < rt_vfloat(1.0f));
    const rt_between c = rt_between_nodes(rt_vfloat(0.5f) * (rt_facet_axis(mu, alpha) + mu), RT_GLASS_COSINES);
    const rt_between r = rt_between_nodes(sqrt(alpha), RT_GLASS_ROUGHNESSES), n = rt_ior_nodes(eta);
    vfloat found[2];
    for (int k = 0; k < 2; ++k) {
        const vint first = ((c.low + rt_vint(k)) * rt_vint(RT_GLASS_ROUGHNESSES) + r.low) * rt_vint(RT_GLASS_IORS) + n.low;
        found[k] = rt_mix(rt_from_either(rt_lost_glass_outside, rt_lost_glass_inside, inside, first, n.share),
                          rt_from_either(rt_lost_glass_outside, rt_lost_glass_inside, inside, first + rt_vint(RT_GLASS_IORS), n.share), r.share);
    }
    return rt_mix(found[0], found[1], c.share);
}
RT_CALLED vfloat rt_lost_by_glass_mean(vfloat alpha, vfloat eta)
{
    const vmask inside = RT_MASK(eta < rt_vfloat(1.0f));
    const rt_between r = rt_between_nodes(sqrt(alpha), 2 * RT_GLASS_ROUGHNESSES - 1), n = rt_ior_nodes(eta);
    const vint first = r.low * rt_vint(RT_GLASS_IORS) + n.low;
    const vfloat mean =
        rt_mix(rt_from_either(rt_lost_glass_outside_mean, rt_lost_glass_inside_mean, inside, first, n.share),
               rt_from_either(rt_lost_glass_outside_mean, rt_lost_glass_inside_mean, inside, first + rt_vint(RT_GLASS_IORS), n.share), r.share);
    return rt_vfloat(RT_LOST_MEAN_SCALE) * alpha * sqrt(alpha) * mean;
}
#endif

#endif
