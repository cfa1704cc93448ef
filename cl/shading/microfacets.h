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

/* The facets of a surface. */
typedef struct rt_facets {
    vfloat alpha; /* 0: smooth. Along a grain and across it alphas differ; even facets of this one lose as much light on average */
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    vfloat along, across;
    vfloat grain_x, grain_y; /* the grain, a unit vector in the surface's frame. Even facets, with the same alpha both ways, have (1, 0) */
    vfloat uneven;           /* (along^2 - across^2) / (along^2 + across^2) */
#endif
} rt_facets;

RT_INLINE rt_facets rt_even_facets(vfloat alpha)
{
    rt_facets f;
    f.alpha = alpha;
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    f.along = f.across = alpha;
    f.grain_x = rt_vfloat(1.0f);
    f.grain_y = f.uneven = rt_vfloat(0.0f);
#endif
    return f;
}

#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
/* Facets across a grain have at least this alpha: floats do not tell the normals of narrower ones apart that are rough along it. */
#define RT_LEAST_ACROSS 1e-3f

/* KHR_materials_anisotropy. alpha: across the grain. strength: 0 to 1. */
RT_INLINE rt_facets rt_grained_facets(vfloat alpha, vfloat strength, vfloat grain_x, vfloat grain_y)
{
    const vfloat one = rt_vfloat(1.0f), rough = rt_max(alpha, rt_vfloat(RT_LEAST_ACROSS));
    const vmask grained = RT_MASK(strength > rt_vfloat(0.0f));
    rt_facets f = rt_even_facets(alpha);
    f.along = rt_select(grained, fma(strength * strength, one - rough, rough), alpha);
    f.across = rt_select(grained, rough, alpha);
    f.grain_x = rt_select(grained, grain_x, f.grain_x);
    f.grain_y = rt_select(grained, grain_y, f.grain_y);
    const vfloat along2 = f.along * f.along, across2 = f.across * f.across, sum = along2 + across2;
    f.uneven = rt_select(grained, (along2 - across2) / rt_max(sum, rt_vfloat(1e-12f)), f.uneven);
    /* Our fit: so their loss, averaged over the hemisphere, is met within 0.003. */
    f.alpha = rt_select(grained, sqrt(rt_vfloat(0.5f) * sum) * fma(rt_vfloat(-0.055f) * f.uneven, f.uneven, one), alpha);
    return f;
}
RT_INLINE rt_facets rt_choose_facets(vmask mask, rt_facets a, rt_facets b)
{
    rt_facets f;
    f.alpha = rt_select(mask, a.alpha, b.alpha);
    f.along = rt_select(mask, a.along, b.along);
    f.across = rt_select(mask, a.across, b.across);
    f.grain_x = rt_select(mask, a.grain_x, b.grain_x);
    f.grain_y = rt_select(mask, a.grain_y, b.grain_y);
    f.uneven = rt_select(mask, a.uneven, b.uneven);
    return f;
}
/* Turn a direction into the frame with x along the grain, and back. */
RT_INLINE rt_vec rt_to_grain(const rt_facets *f, rt_vec w)
{
    return rt_vec_of(fma(f->grain_x, w.x, f->grain_y * w.y), fma(f->grain_x, w.y, -f->grain_y * w.x), w.z);
}
RT_INLINE rt_vec rt_from_grain(const rt_facets *f, rt_vec w)
{
    return rt_vec_of(fma(f->grain_x, w.x, -f->grain_y * w.y), fma(f->grain_x, w.y, f->grain_y * w.x), w.z);
}
#else
RT_INLINE rt_facets rt_choose_facets(vmask mask, rt_facets a, rt_facets b) { return rt_even_facets(rt_select(mask, a.alpha, b.alpha)); }
#endif

/* The same, and none is smooth: for what is computed in all lanes. */
RT_INLINE rt_facets rt_rough_facets(const rt_facets *f)
{
    rt_facets rough = *f;
    rough.alpha = rt_max(f->alpha, rt_vfloat(RT_LEAST_ALPHA));
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    rough.along = rt_max(f->along, rt_vfloat(RT_LEAST_ALPHA));
    rough.across = rt_max(f->across, rt_vfloat(RT_LEAST_ALPHA));
#endif
    return rough;
}

/* The alpha of even facets that have the loss, or the reflection at grazing angles, of facets with a grain, for light from w. Our fits:
 * for strengths to 1 and alphas across from 0 to 0.5, at grazing angles up to 0.12 of all light is off, and 0.003 on average. */
#define RT_SWING_OF_LOSS -1.1f
#define RT_SWING_OF_GRAZING 2.0f
RT_INLINE vfloat rt_even_alpha(const rt_facets *f, rt_vec w, float swing)
{
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    const vfloat one = rt_vfloat(1.0f), mu = rt_min(fabs(w.z), one), low = one - mu;
    const rt_vec g = rt_to_grain(f, w);
    /* low^3 times the cosine of twice the angle from the grain */
    const vfloat turn = low * low * fma(g.x, g.x, -g.y * g.y) / (one + mu);
    return rt_min(f->alpha * rt_exp(rt_vfloat(swing) * f->uneven * turn), rt_max(f->alpha, one));
#else
    return f->alpha;
#endif
}

/* D of the facets whose normal is along h, a vector of any length. */
RT_INLINE vfloat rt_facets_along(rt_vec h, const rt_facets *f)
{
    const vfloat alpha2 = f->alpha * f->alpha, across = fma(h.x, h.x, h.y * h.y);
    vfloat stretched = across / alpha2, area = alpha2;
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    const rt_vec g = rt_to_grain(f, h);
    const vfloat x = g.x / f->along, y = g.y / f->across;
    const vmask even = RT_MASK(f->uneven == rt_vfloat(0.0f));
    stretched = rt_select(even, stretched, fma(x, x, y * y));
    area = rt_select(even, area, f->along * f->across);
#endif
    const vfloat t = (stretched + h.z * h.z) / rt_max(fma(h.z, h.z, across), rt_vfloat(1e-36f));
    return rt_vfloat(RT_INVERSE_PI) / (area * t * t);
}

/* 1 + 2 Lambda of Smith for a direction. The facets that are seen from there: G1 = 2 / (1 + smith). Seen and lit on one side, their
 * heights the same: G2 = 2 / (smith + smith'). */
RT_INLINE vfloat rt_smith(rt_vec w, const rt_facets *f)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), mu2 = rt_max(w.z * w.z, rt_vfloat(1e-12f));
    vfloat alpha2 = f->alpha * f->alpha;
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    const rt_vec g = rt_to_grain(f, w);
    const vfloat x = g.x * f->along, y = g.y * f->across, wide = fma(x, x, y * y) / rt_max(fma(g.x, g.x, g.y * g.y), rt_vfloat(1e-12f));
    alpha2 = rt_select(RT_MASK(f->uneven == zero), alpha2, wide);
#endif
    return sqrt(fma(alpha2, rt_max(one - mu2, zero) / mu2, one));
}

/* rt_warp_visible_normal() of these facets. */
RT_INLINE rt_vec rt_visible_normal(rt_vec wo, const rt_facets *f, vfloat u1, vfloat u2)
{
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    return rt_from_grain(f, rt_warp_visible_normal(rt_to_grain(f, wo), f->along, f->across, u1, u2));
#else
    return rt_warp_visible_normal(wo, f->alpha, f->alpha, u1, u2);
#endif
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

/* The mean reflectance of smooth glass from its thinner side: a fit of Kulla and Conty 2017. n: 1 or more. */
RT_INLINE vfloat rt_glass_mean(vfloat n) { return (n - rt_vfloat(1.0f)) / fma(n, rt_vfloat(1.00071f), rt_vfloat(4.08567f)); }

#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
RT_INLINE vfloat rt_schlick_weight(vfloat cosine)
{
    const vfloat c = rt_max(rt_vfloat(1.0f) - cosine, rt_vfloat(0.0f)), c2 = c * c;
    return c2 * c2 * c;
}
#endif

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
