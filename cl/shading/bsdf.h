/* bsdf.h -- what the path tracer takes a surface for: its values, its densities, and directions drawn from it.
 *
 * A surface is a sum of lobes with shares: diffuse (Lambert), mirror, metal and glass. Lambert has one of them, Whitted's mixture has
 * three. All directions are in the frame of the shading normal, z, and point away from the surface; wo.z > 0. Light is a radiance,
 * so what a surface lets through is divided by eta^2 (Veach 1997, Robust Monte Carlo Methods, section 5.2). */
#ifndef RT_BSDF_H
#define RT_BSDF_H

typedef struct rt_bsdf {
    rt_vec color;
    vfloat diffuse, mirror, metal, glass; /* shares */
    vfloat alpha;                         /* of metal and glass; 0: smooth */
    vfloat eta;                           /* ior of the other side / ior of this side */
    vmask compensate;                     /* light may meet several facets */
} rt_bsdf;

typedef struct rt_bsdf_sample {
    rt_vec wi, weight; /* weight: f |cos| / pdf */
    vfloat pdf;        /* per solid angle; of a delta lobe the probability of the lobe */
    vmask valid, delta, transmitted;
} rt_bsdf_sample;

/* The probabilities with which rt_bsdf_draw() picks a lobe. */
typedef struct rt_bsdf_lobes {
    vfloat diffuse, mirror, metal, glass; /* their sum is 1, or 0 of a black surface */
    vfloat again;                         /* metal: of more than one facet, among those of a metal */
} rt_bsdf_lobes;

RT_INLINE rt_bsdf_lobes rt_bsdf_lobes_of(const rt_bsdf *b, vfloat mu)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_bsdf_lobes p;
    const vfloat diffuse = b->diffuse * rt_largest(b->color);
    const vfloat sum = diffuse + b->mirror + b->metal + b->glass;
    const vfloat scale = one / rt_max(sum, rt_vfloat(1e-20f));
    p.diffuse = diffuse * scale;
    p.mirror = b->mirror * scale;
    p.metal = b->metal * scale;
    p.glass = b->glass * scale;
    p.again = zero;
    const vmask rough_metal = RT_MASK(b->metal > zero) & RT_MASK(b->alpha > zero) & b->compensate;
    if (rt_any(rough_metal)) p.again = rt_select(rough_metal, rt_lost_by_metal(mu, b->alpha), zero);
    return p;
}

/* f(wo, wi) |cos wi| of the lobes that are no deltas. *pdf: the density with which rt_bsdf_draw() gives wi. Both are 0 in other lanes. */
RT_INLINE rt_vec rt_bsdf_eval(const rt_bsdf *b, rt_vec wo, rt_vec wi, vmask lanes, vfloat *pdf)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_bsdf_lobes p = rt_bsdf_lobes_of(b, wo.z);
    const vmask above = lanes & RT_MASK(wi.z > zero) & RT_MASK(wo.z > zero);
    const vfloat cosine = rt_vfloat(RT_INVERSE_PI) * wi.z;
    rt_vec f = rt_scale(rt_select(above, b->diffuse * cosine, zero), b->color);
    *pdf = rt_select(above, p.diffuse * cosine, zero);

    const vmask rough = above & RT_MASK(b->metal > zero) & RT_MASK(b->alpha > zero);
    if (rt_any(rough)) {
        const vfloat alpha = rt_max(b->alpha, rt_vfloat(RT_LEAST_ALPHA));
        const rt_vec along = rt_add(wo, wi);
        const vfloat to_facet = rt_dot(wo, rt_normalize(along));
        const vfloat smith_o = rt_smith(wo.z, alpha), smith_i = rt_smith(wi.z, alpha);
        const vfloat seen = rt_facets_along(along, alpha) / (rt_vfloat(2.0f) * wo.z); /* D / (4 cos wo), times G */
        const rt_vec fresnel = rt_fresnel_metal(b->color, to_facet);
        rt_vec value = rt_scale(seen / (smith_o + smith_i), fresnel);
        vfloat density = (one - p.again) * seen / (one + smith_o);
        if (rt_any(rough & b->compensate)) {
            /* Kulla and Conty 2017. The metal's mean reflectance is Schlick's; each further facet reflects it once more. */
            const vfloat mean = rt_max(rt_lost_by_metal_mean(alpha), rt_vfloat(1e-9f));
            const vfloat share = cosine * p.again * rt_lost_by_metal(wi.z, alpha) / mean;
            const rt_vec average = rt_along(rt_vfloat(20.0f / 21.0f), b->color, rt_splat(1.0f / 21.0f, 1.0f / 21.0f, 1.0f / 21.0f));
            const vfloat kept = one - mean;
            const rt_vec several = rt_vec_of(average.x * average.x * kept / (one - average.x * mean), average.y * average.y * kept / (one - average.y * mean),
                                             average.z * average.z * kept / (one - average.z * mean));
            value = rt_along(rt_select(b->compensate, share, zero), several, value);
            density = fma(p.again, cosine, density);
        }
        f = rt_choose(rough, rt_along(b->metal, value, f), f);
        *pdf = rt_select(rough, fma(p.metal, density, *pdf), *pdf);
    }
    return f;
}

/* Whether a lobe of probability p is picked. u, in [0, 1), becomes the rest of the choice, in [0, 1) again. */
RT_INLINE vmask rt_pick(vfloat p, vfloat *u)
{
    const vfloat one = rt_vfloat(1.0f);
    const vmask picked = RT_MASK(*u < p);
    const vfloat rest = rt_select(picked, *u / rt_max(p, rt_vfloat(1e-20f)), (*u - p) / rt_max(one - p, rt_vfloat(1e-20f)));
    *u = rt_min(rest, rt_vfloat(0.99999994f));
    return picked;
}

/* Draws a direction. u_lobe, u1, u2: in [0, 1). Lanes that get none, or are not in `lanes`, are not valid. */
RT_INLINE rt_bsdf_sample rt_bsdf_draw(const rt_bsdf *b, rt_vec wo, vfloat u_lobe, vfloat u1, vfloat u2, vmask lanes)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const vmask smooth = RT_MASK(b->alpha <= zero);
    const rt_bsdf_lobes p = rt_bsdf_lobes_of(b, wo.z);
    rt_bsdf_sample s;
    /* The diffuse lobe comes first, then mirror, metal, glass. */
    vmask left = lanes & RT_MASK(wo.z > zero) & RT_MASK(p.diffuse + p.mirror + p.metal + p.glass > zero);
    const vmask diffuse = left & rt_pick(p.diffuse, &u_lobe);
    left &= ~diffuse;
    const vmask mirror = left & rt_pick(p.mirror / rt_max(one - p.diffuse, rt_vfloat(1e-20f)), &u_lobe);
    left &= ~mirror;
    const vmask metal = left & (rt_pick(p.metal / rt_max(p.metal + p.glass, rt_vfloat(1e-20f)), &u_lobe) | RT_MASK(p.glass <= zero));
    const vmask glass = left & ~metal;

    s.wi = rt_vec_of(-wo.x, -wo.y, wo.z);
    s.weight = rt_splat(0.0f, 0.0f, 0.0f);
    s.pdf = zero;
    s.delta = mirror | (smooth & (metal | glass));
    s.transmitted = rt_vint(0);
    if (rt_any(s.delta)) {
        const vfloat share = rt_select(mirror, b->mirror / rt_max(p.mirror, rt_vfloat(1e-20f)), b->metal / rt_max(p.metal, rt_vfloat(1e-20f)));
        s.weight = rt_scale(share, rt_choose(mirror, rt_splat(1.0f, 1.0f, 1.0f), rt_fresnel_metal(b->color, wo.z)));
        s.pdf = rt_select(mirror, p.mirror, p.metal);
        if (rt_any(glass & smooth)) {
            vfloat cos_out;
            const vfloat reflected = rt_fresnel_dielectric(wo.z, b->eta, &cos_out);
            const vfloat glass_share = b->glass / rt_max(p.glass, rt_vfloat(1e-20f));
            const vmask back = glass & smooth & rt_pick(reflected, &u_lobe), through = glass & smooth & ~back;
            s.transmitted |= through;
            s.pdf = rt_select(back, p.glass * reflected, rt_select(through, p.glass * (one - reflected), s.pdf));
            s.weight = rt_choose(back, rt_vec_of(glass_share, glass_share, glass_share), s.weight);
            s.weight = rt_choose(through, rt_scale(glass_share / (b->eta * b->eta), b->color), s.weight);
            s.wi = rt_choose(through, rt_vec_of(-wo.x / b->eta, -wo.y / b->eta, -cos_out), s.wi);
        }
    }

    const vmask spread = (diffuse | metal) & ~s.delta;
    s.valid = s.delta;
    if (rt_any(spread)) {
        const vmask facets = spread & metal & ~rt_pick(p.again, &u_lobe);
        rt_vec wi = rt_warp_cosine(u1, u2);
        if (rt_any(facets)) {
            const rt_vec h = rt_warp_visible_normal(wo, rt_max(b->alpha, rt_vfloat(RT_LEAST_ALPHA)), u1, u2);
            const vfloat to_facet = rt_dot(wo, h);
            wi = rt_choose(facets, rt_sub(rt_scale(to_facet + to_facet, h), wo), wi);
        }
        vfloat pdf;
        const rt_vec f = rt_bsdf_eval(b, wo, wi, spread, &pdf);
        s.valid |= spread & RT_MASK(pdf > zero);
        s.wi = rt_choose(spread, wi, s.wi);
        s.pdf = rt_select(spread, pdf, s.pdf);
        s.weight = rt_choose(spread, rt_scale(one / rt_max(pdf, rt_vfloat(1e-30f)), f), s.weight);
    }
    return s;
}

#endif
