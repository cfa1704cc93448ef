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
    rt_facets facets;                     /* of metal and glass */
    vfloat eta;                           /* ior of the other side / ior of this side */
    vmask compensate;                     /* light may meet several facets */
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    rt_layered layered; /* where it has lanes, glass is the only other share */
#endif
} rt_bsdf;

typedef struct rt_bsdf_sample {
    rt_vec wi, weight; /* weight: f |cos| / pdf */
    vfloat pdf;        /* per solid angle; of a delta lobe the probability of the lobe */
    vmask valid, delta, transmitted;
} rt_bsdf_sample;

/* The probabilities with which rt_bsdf_draw() picks a lobe. */
typedef struct rt_bsdf_lobes {
    vfloat diffuse, mirror, metal, glass; /* their sum is 1, or 0 of a black surface */
    vfloat again;                         /* of light that meets several facets, among that of metal or glass */
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    vfloat layers;          /* all lobes of layers.h together */
    rt_layer_lobes layered; /* each of them, among these */
    vfloat glass_dim;       /* by which they dim glass */
#endif
} rt_bsdf_lobes;

/* The lanes that scatter diffusely, and those that light goes straight through, without a medium. */
RT_INLINE vmask rt_is_diffuse(const rt_bsdf *b)
{
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    return RT_MASK(rt_select(b->layered.lanes, b->layered.diffuse, b->diffuse) > rt_vfloat(0.0f));
#else
    return RT_MASK(b->diffuse > rt_vfloat(0.0f));
#endif
}
/* The lanes with light that comes from the other side. */
RT_INLINE vmask rt_lets_through(const rt_bsdf *b)
{
    const vfloat zero = rt_vfloat(0.0f);
    vmask through = RT_MASK(b->glass > zero);
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    through |= b->layered.lanes & RT_MASK(b->layered.thin > zero);
#endif
    return through;
}
RT_INLINE vmask rt_is_sheet(const rt_bsdf *b)
{
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    return b->layered.sheet;
#else
    return rt_vint(0);
#endif
}

/* The lanes with facets. */
RT_INLINE vmask rt_is_rough(const rt_bsdf *b, vfloat share) { return RT_MASK(share > rt_vfloat(0.0f)) & RT_MASK(b->facets.alpha > rt_vfloat(0.0f)); }

#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
/* What glass that reflects less or more than by Fresnel's equations loses between facets. lost: by these. by_metal: if all is mirrored. */
RT_INLINE vfloat rt_change_lost(const rt_layered *l, vfloat eta, vfloat lost, vfloat by_metal)
{
    const vfloat weak = lost * rt_select(RT_MASK(eta > rt_vfloat(1.0f)), l->glass_weak, rt_vfloat(1.0f));
    return rt_select(l->changed, rt_mix(weak, by_metal, l->glass_mirror), lost);
}
#endif
/* What facets of glass lose of light from w, and its mean over the hemisphere. eta: ior of the other side / ior of the side of w. */
RT_INLINE vfloat rt_lost_by_frosted(const rt_bsdf *b, rt_vec w, vfloat eta)
{
    const vfloat alpha = rt_max(rt_even_alpha(&b->facets, w, RT_SWING_OF_LOSS), rt_vfloat(RT_LEAST_ALPHA)), mu = rt_min(fabs(w.z), rt_vfloat(1.0f));
    vfloat lost = rt_lost_by_glass(mu, alpha, eta);
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
    lost = rt_change_lost(&b->layered, eta, lost, rt_lost_by_metal(mu, alpha));
#endif
    return lost;
}
RT_INLINE vfloat rt_lost_by_frosted_mean(const rt_bsdf *b, vfloat eta)
{
    vfloat lost = rt_lost_by_glass_mean(b->facets.alpha, eta);
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
    lost = rt_change_lost(&b->layered, eta, lost, rt_lost_by_metal_mean(b->facets.alpha));
#endif
    return lost;
}
#endif

RT_INLINE rt_bsdf_lobes rt_bsdf_lobes_of(const rt_bsdf *b, rt_vec wo)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), mu = wo.z;
    rt_bsdf_lobes p;
    const vfloat diffuse = b->diffuse * rt_largest(b->color);
    vfloat clear = b->glass;
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    p.layered = rt_layer_lobes_of(&b->layered, wo);
    p.layers = rt_select(b->layered.lanes, p.layered.albedo, zero);
    p.glass_dim = rt_select(b->layered.lanes, p.layered.below, one);
    clear *= p.glass_dim;
    const vfloat sum = diffuse + b->mirror + b->metal + clear + p.layers;
#else
    const vfloat sum = diffuse + b->mirror + b->metal + clear;
#endif
    const vfloat scale = one / rt_max(sum, rt_vfloat(1e-20f));
    p.diffuse = diffuse * scale;
    p.mirror = b->mirror * scale;
    p.metal = b->metal * scale;
    p.glass = clear * scale;
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    p.layers *= scale;
#endif
    p.again = zero;
#if RT_MAY_SCATTER(RT_LOBE_METAL)
    const vmask metal = rt_is_rough(b, b->metal) & b->compensate;
    if (rt_any(metal)) p.again = rt_select(metal, rt_lost_by_metal(mu, rt_even_alpha(&b->facets, wo, RT_SWING_OF_LOSS)), zero);
#endif
#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
    const vmask glass = rt_is_rough(b, b->glass) & b->compensate;
    if (rt_any(glass)) p.again = rt_select(glass, rt_lost_by_frosted(b, wo, b->eta), p.again);
#endif
    return p;
}

/* What glass reflects, and the share of draws that are mirrored. cos_in, cos_out: on both sides. */
typedef struct rt_glass_mirror {
    rt_vec color;
    vfloat chance;
} rt_glass_mirror;
RT_INLINE rt_glass_mirror rt_glass_mirror_of(const rt_bsdf *b, vfloat cos_in, vfloat *cos_out)
{
    const vfloat exact = rt_fresnel_dielectric(cos_in, b->eta, cos_out);
    rt_glass_mirror m;
    m.color = rt_vec_of(exact, exact, exact);
    m.chance = exact;
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
    m.color = rt_glass_fresnel(&b->layered, exact, b->eta, rt_select(RT_MASK(b->eta < rt_vfloat(1.0f)), *cos_out, cos_in));
    m.chance = rt_select(b->layered.changed, (m.color.x + m.color.y + m.color.z) * rt_vfloat(1.0f / 3.0f), exact);
#endif
    return m;
}

#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
/* One channel of glass with facets. */
RT_INLINE vfloat rt_frosted_channel(vmask through, vfloat reflected, vfloat mirrored, vfloat passed, vfloat color)
{
    return rt_select(through, (rt_vfloat(1.0f) - reflected) * passed * color, reflected * mirrored);
}

/* Light that meets several facets of a dielectric: the share that goes through, and the mean losses of both sides. The shares of both
 * sides keep light reciprocal: through mean_here = eta^2 through' mean_there, as 1 - mean reflectance of the two sides do. */
typedef struct rt_glass_again {
    vfloat through, mean_here, mean_there;
} rt_glass_again;
RT_INLINE rt_glass_again rt_glass_again_of(const rt_bsdf *b)
{
    const vfloat one = rt_vfloat(1.0f), least = rt_vfloat(1e-9f);
    rt_glass_again g;
    g.mean_here = rt_max(rt_lost_by_frosted_mean(b, b->eta), least);
    g.mean_there = rt_max(rt_lost_by_frosted_mean(b, one / b->eta), least);
    const vfloat n = rt_max(b->eta, one / b->eta);
    vfloat mean = rt_glass_mean(n);
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
    mean = rt_select(b->layered.changed, b->layered.glass_mean, mean);
#endif
    const vfloat let_in = one - mean;
    g.through = rt_select(RT_MASK(b->eta < one), let_in * b->eta * b->eta, let_in) * rt_min(one, g.mean_there / g.mean_here);
    return g;
}

/* The same as rt_bsdf_eval() of a rough dielectric alone (Walter et al. 2007; Kulla and Conty 2017). */
RT_INLINE rt_vec rt_frosted_eval(const rt_bsdf *b, const rt_bsdf_lobes *p, rt_vec wo, rt_vec wi, vfloat *density)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), two = rt_vfloat(2.0f);
    const vfloat eta = b->eta, mu_i = fabs(wi.z);
    const rt_facets rough = rt_rough_facets(&b->facets);
    const vmask through = RT_MASK(wi.z < zero);
    /* The facet's normal halves the angle of mirrored light; of refracted light it is along wo + eta wi. */
    rt_vec along = rt_along(rt_select(through, eta, one), wi, wo);
    along = rt_scale(rt_select(RT_MASK(along.z < zero), -one, one), along);
    const vfloat scale = rt_inverse_length(along);
    const vfloat to_facet = scale * rt_dot(wo, along), from_facet = scale * rt_dot(wi, along);
    vfloat cos_out;
    const rt_glass_mirror mirror = rt_glass_mirror_of(b, rt_max(to_facet, zero), &cos_out);
    const vfloat smith_o = rt_smith(wo, &rough), smith_i = rt_smith(wi, &rough);
    const vfloat facets = rt_facets_along(along, &rough) / wo.z;
    /* D / (4 cos wo) times G, and D |wo.h| |wi.h| / ((wo.h + eta wi.h)^2 cos wo) times G, without and with the eta^2 of a density. */
    const vfloat bent = facets * to_facet * -from_facet * scale * scale;
    const vmask meets = RT_MASK(to_facet > zero) & (~through | RT_MASK(from_facet < zero));
    const vfloat mirrored = rt_select(meets, facets / (two * (smith_o + smith_i)), zero);
    const vfloat passed = rt_select(meets, bent * rt_vfloat(4.0f) / ((one + smith_o) * (one + smith_i)), zero);
    const vfloat mirrored_density = mirror.chance * facets / (two * (one + smith_o)), passed_density = (one - mirror.chance) * bent * eta * eta * two / (one + smith_o);
    rt_vec value = rt_vec_of(rt_frosted_channel(through, mirror.color.x, mirrored, passed, b->color.x), rt_frosted_channel(through, mirror.color.y, mirrored, passed, b->color.y),
                             rt_frosted_channel(through, mirror.color.z, mirrored, passed, b->color.z));
    *density = (one - p->again) * rt_select(meets, rt_select(through, passed_density, mirrored_density), zero);
    if (rt_any(b->compensate & rt_is_rough(b, b->glass))) {
        const rt_glass_again g = rt_glass_again_of(b);
        const vfloat cosine = rt_vfloat(RT_INVERSE_PI) * mu_i;
        const vfloat lost_i = rt_lost_by_frosted(b, wi, rt_select(through, one / eta, eta));
        const vfloat share = rt_select(through, g.through / (g.mean_there * eta * eta), (one - g.through) / g.mean_here);
        const vfloat several = rt_select(b->compensate, p->again, zero) * cosine * lost_i * share;
        value = rt_add(value, rt_choose(through, rt_scale(several, b->color), rt_vec_of(several, several, several)));
        *density = fma(p->again, cosine * rt_select(through, g.through, one - g.through), *density);
    }
    return value;
}
#endif

/* f(wo, wi) |cos wi| of the lobes that are no deltas. *pdf: the density with which rt_bsdf_draw() gives wi. Both are 0 in other lanes. */
RT_CALLED rt_vec rt_bsdf_eval(const rt_bsdf *b, rt_vec wo, rt_vec wi, vmask lanes, vfloat *pdf)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_bsdf_lobes p = rt_bsdf_lobes_of(b, wo);
    const vmask above = lanes & RT_MASK(wi.z > zero) & RT_MASK(wo.z > zero);
    const vfloat cosine = rt_vfloat(RT_INVERSE_PI) * wi.z;
    rt_vec f = rt_scale(rt_select(above, b->diffuse * cosine, zero), b->color);
    *pdf = rt_select(above, p.diffuse * cosine, zero);

#if RT_MAY_SCATTER(RT_LOBE_METAL)
    const vmask rough = above & rt_is_rough(b, b->metal);
    if (rt_any(rough)) {
        const rt_facets facets = rt_rough_facets(&b->facets);
        const rt_vec along = rt_add(wo, wi);
        const vfloat to_facet = rt_dot(wo, rt_normalize(along));
        const vfloat smith_o = rt_smith(wo, &facets), smith_i = rt_smith(wi, &facets);
        const vfloat seen = rt_facets_along(along, &facets) / (rt_vfloat(2.0f) * wo.z); /* D / (4 cos wo), times G */
        const rt_vec fresnel = rt_fresnel_metal(b->color, to_facet);
        rt_vec value = rt_scale(seen / (smith_o + smith_i), fresnel);
        vfloat density = (one - p.again) * seen / (one + smith_o);
        if (rt_any(rough & b->compensate)) {
            /* Kulla and Conty 2017. The metal's mean reflectance is Schlick's; each further facet reflects it once more. */
            const vfloat mean = rt_max(rt_lost_by_metal_mean(facets.alpha), rt_vfloat(1e-9f));
            const vfloat share = cosine * p.again * rt_lost_by_metal(wi.z, rt_even_alpha(&facets, wi, RT_SWING_OF_LOSS)) / mean;
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
#endif
#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
    const vmask frosted = lanes & RT_MASK(wo.z > zero) & RT_MASK(wi.z != zero) & rt_is_rough(b, b->glass);
    if (rt_any(frosted)) {
        vfloat density;
        const rt_vec value = rt_frosted_eval(b, &p, wo, wi, &density);
        f = rt_choose(frosted, rt_along(b->glass, value, f), f);
        *pdf = rt_select(frosted, fma(p.glass, density, *pdf), *pdf);
    }
#endif
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    const vmask layered = lanes & b->layered.lanes & RT_MASK(wo.z > zero) & RT_MASK(wi.z != zero);
    if (rt_any(layered)) {
        vfloat density;
        f = rt_choose(layered, rt_layers_eval(&b->layered, &p.layered, wo, wi, f, &density), f);
        *pdf = rt_select(layered, fma(p.layers, density, *pdf), *pdf);
    }
#endif
    return f;
}

/* The lanes of `of` in which a lobe of probability p is picked. Their u, in [0, 1), becomes the rest of the choice, in [0, 1) again. What
 * happens in a lane must not depend on others, so theirs stay. */
RT_INLINE vmask rt_takes_lobe(vmask of, vfloat p, vfloat *u)
{
    const vfloat one = rt_vfloat(1.0f);
    const vmask picked = RT_MASK(*u < p);
    const vfloat rest = rt_select(picked, *u / rt_max(p, rt_vfloat(1e-20f)), (*u - p) / rt_max(one - p, rt_vfloat(1e-20f)));
    *u = rt_select(of, rt_min(rest, rt_vfloat(0.99999994f)), *u);
    return of & picked;
}

/* Draws a direction. u_lobe, u1, u2: in [0, 1). Lanes that get none, or are not in `lanes`, are not valid. */
RT_PART rt_bsdf_sample rt_bsdf_draw(const rt_bsdf *b, rt_vec wo, vfloat u_lobe, vfloat u1, vfloat u2, vmask lanes)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const vmask smooth = RT_MASK(b->facets.alpha <= zero);
    const rt_bsdf_lobes p = rt_bsdf_lobes_of(b, wo);
    rt_bsdf_sample s;
    /* The layers come first, then the diffuse lobe, mirror, metal, glass. */
    const vfloat others = p.mirror + p.metal + p.glass;
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    vmask left = lanes & RT_MASK(wo.z > zero) & RT_MASK(p.diffuse + others + p.layers > zero);
    const vmask layers = rt_takes_lobe(left & b->layered.lanes, rt_select(RT_MASK(others > zero), p.layers, one), &u_lobe);
    left &= ~layers;
#else
    vmask left = lanes & RT_MASK(wo.z > zero) & RT_MASK(p.diffuse + others > zero);
#endif
    vmask diffuse = left, mirror = rt_vint(0);
    /* A share that alone is 1 may be rounded. */
    if (RT_LOBES != 0u) diffuse = rt_takes_lobe(left, rt_select(RT_MASK(others > zero), p.diffuse, one), &u_lobe);
    left &= ~diffuse;
    if (RT_MAY_SCATTER(RT_LOBE_MIRROR)) mirror = rt_takes_lobe(left, p.mirror / rt_max(one - p.diffuse, rt_vfloat(1e-20f)), &u_lobe);
    left &= ~mirror;
    const vmask metal = left & RT_MASK(p.metal > zero), glass = left & ~metal; /* no surface is both */

    s.wi = rt_vec_of(-wo.x, -wo.y, wo.z);
    s.weight = rt_splat(0.0f, 0.0f, 0.0f);
    s.pdf = zero;
    s.delta = mirror | (smooth & (metal | glass));
    s.transmitted = rt_vint(0);
    if (RT_MAY_SCATTER(RT_LOBE_MIRROR | RT_LOBE_METAL | RT_LOBE_GLASS) && rt_any(s.delta)) {
        const vfloat share = rt_select(mirror, b->mirror / rt_max(p.mirror, rt_vfloat(1e-20f)), b->metal / rt_max(p.metal, rt_vfloat(1e-20f)));
        s.weight = rt_scale(share, rt_choose(mirror, rt_splat(1.0f, 1.0f, 1.0f), rt_fresnel_metal(b->color, wo.z)));
        s.pdf = rt_select(mirror, p.mirror, p.metal);
        if (RT_MAY_SCATTER(RT_LOBE_GLASS) && rt_any(glass & smooth)) {
            vfloat cos_out;
            const rt_glass_mirror m = rt_glass_mirror_of(b, wo.z, &cos_out);
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
            const vfloat glass_share = b->glass * p.glass_dim / rt_max(p.glass, rt_vfloat(1e-20f));
#else
            const vfloat glass_share = b->glass / rt_max(p.glass, rt_vfloat(1e-20f));
#endif
            const vmask back = rt_takes_lobe(glass & smooth, m.chance, &u_lobe), through = glass & smooth & ~back;
            s.transmitted |= through;
            s.pdf = rt_select(back, p.glass * m.chance, rt_select(through, p.glass * (one - m.chance), s.pdf));
            s.wi = rt_choose(through, rt_vec_of(-wo.x / b->eta, -wo.y / b->eta, -cos_out), s.wi);
            rt_vec mirrored = rt_splat(1.0f, 1.0f, 1.0f), passed = b->color;
            vfloat bent_share = glass_share / (b->eta * b->eta);
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
            /* Channels differ by what the chance leaves over. */
            const vmask changed = b->layered.changed;
            mirrored = rt_choose(changed, rt_scale(one / rt_max(m.chance, rt_vfloat(1e-20f)), m.color), mirrored);
            passed = rt_choose(changed, rt_scale(one / rt_max(one - m.chance, rt_vfloat(1e-20f)), rt_mul(passed, rt_rest(m.color))), passed);
#endif
#if RT_MAY_SCATTER(RT_LOBE_COAT | RT_LOBE_SHEEN)
            const rt_aspect from = rt_aspect_of(&b->layered, s.wi);
            const vfloat dimmed = bent_share * rt_below_through(&p.layered.from, &from) / rt_max(p.glass_dim, rt_vfloat(1e-20f));
            bent_share = rt_select(b->layered.lanes, dimmed, bent_share);
#endif
            s.weight = rt_choose(back, rt_scale(glass_share, mirrored), s.weight);
            s.weight = rt_choose(through, rt_scale(bent_share, passed), s.weight);
        }
    }

    vmask spread = (diffuse | metal | glass) & ~s.delta;
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
    rt_vec layer_wi = s.wi;
    if (rt_any(layers)) {
        const rt_layers_sample from = rt_layers_draw(&b->layered, &p.layered, wo, u_lobe, u1, u2);
        const vmask there = layers & RT_MASK(from.wi.z != zero), mirrored = there & from.delta;
        layer_wi = from.wi;
        s.delta |= mirrored;
        s.wi = rt_choose(mirrored, from.wi, s.wi);
        s.weight = rt_choose(mirrored, rt_scale(one / rt_max(p.layers, rt_vfloat(1e-20f)), from.weight), s.weight);
        s.pdf = rt_select(mirrored, p.layers * from.pdf, s.pdf);
        s.transmitted |= mirrored & RT_MASK(from.wi.z < zero);
        spread |= there & ~from.delta;
    }
#endif
    s.valid = s.delta;
    if (rt_any(spread)) {
        const vmask facets = (metal | glass) & spread & ~rt_takes_lobe((metal | glass) & spread, p.again, &u_lobe), frosted = spread & glass;
        rt_vec wi = rt_warp_cosine(u1, u2);
        vmask through = rt_vint(0);
#if RT_MAY_SCATTER(RT_LOBE_FROSTED)
        if (rt_any(frosted & ~facets)) {
            through = rt_takes_lobe(frosted & ~facets, rt_glass_again_of(b).through, &u_lobe);
            wi.z = rt_select(through, -wi.z, wi.z);
        }
#endif
        if (RT_MAY_SCATTER(RT_LOBE_METAL | RT_LOBE_FROSTED) && rt_any(facets)) {
            const rt_facets rough = rt_rough_facets(&b->facets);
            const rt_vec h = rt_visible_normal(wo, &rough, u1, u2);
            const vfloat to_facet = rt_max(rt_dot(wo, h), zero);
            rt_vec along = rt_sub(rt_scale(to_facet + to_facet, h), wo);
            if (RT_MAY_SCATTER(RT_LOBE_FROSTED) && rt_any(frosted & facets)) {
                vfloat cos_out;
                const rt_glass_mirror m = rt_glass_mirror_of(b, to_facet, &cos_out);
                const vmask bent = frosted & facets & ~rt_takes_lobe(frosted & facets, m.chance, &u_lobe);
                through |= bent;
                const rt_vec refracted = rt_along(to_facet / b->eta - cos_out, h, rt_scale(-one / b->eta, wo));
                along = rt_choose(bent, refracted, along);
            }
            wi = rt_choose(facets, along, wi);
        }
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)
        wi = rt_choose(layers, layer_wi, wi);
        through |= layers & RT_MASK(layer_wi.z < zero);
#endif
        vfloat pdf;
        const rt_vec f = rt_bsdf_eval(b, wo, wi, spread, &pdf);
        s.valid |= spread & RT_MASK(pdf > zero) & RT_MASK(rt_select(through, -wi.z, wi.z) > zero);
        s.transmitted |= through;
        s.wi = rt_choose(spread, wi, s.wi);
        s.pdf = rt_select(spread, pdf, s.pdf);
        s.weight = rt_choose(spread, rt_scale(one / rt_max(pdf, rt_vfloat(1e-30f)), f), s.weight);
    }
    return s;
}

#endif
