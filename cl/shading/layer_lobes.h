/* layer_lobes.h -- the lobes of layers.h: their values, their densities, and directions drawn from them. */
#ifndef RT_LAYER_LOBES_H
#define RT_LAYER_LOBES_H
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)

/* The probabilities of draws. Their sum is 1, or 0 of a black surface. */
typedef struct rt_layer_lobes {
    vfloat cosine, facets, coat, sheen, thin, thin_cosine;
    vfloat albedo; /* by which they were divided */
    vfloat below;  /* by which the layers dim solid glass, for the choice */
    rt_aspect from;
} rt_layer_lobes;

RT_INLINE rt_layer_lobes rt_layer_lobes_of(const rt_layered *l, rt_vec wo)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_layer_lobes p;
    p.from = rt_aspect_of(l, wo);
    const rt_aspect *a = &p.from;
    const vfloat color = rt_largest(l->color), gloss = rt_max(fma(-a->lost, rt_largest(l->gloss_again), a->gloss), zero);
    const vfloat metal_again = rt_largest(l->metal_again), gloss_again = rt_largest(l->gloss_again);
    p.below = (one - a->coat) * (one - a->sheen);
    const vfloat metal = rt_filmed(l, rt_metal_fresnel(l, wo.z), a->lost, rt_facets_albedo(color, one, a->lost, a->bent));
    p.facets = p.below * fma(l->metal, metal, l->gloss * gloss);
    p.cosine = p.below * fma(l->diffuse * color, one - a->gloss, a->lost * fma(l->metal, metal_again, l->gloss * gloss_again));
    p.thin = p.thin_cosine = zero;
    if (RT_MAY_SCATTER(RT_LOBE_THIN)) {
        const vfloat clear = p.below * l->thin * color;
        p.thin = clear * rt_max(one - a->lost - gloss, zero);
        p.thin_cosine = clear * a->lost * (one - gloss_again);
    }
    p.coat = a->coat;
    p.sheen = (one - a->coat) * a->sheen;
    p.albedo = p.facets + p.cosine + p.thin + p.thin_cosine + p.coat + p.sheen;
    const vfloat scale = one / rt_max(p.albedo, rt_vfloat(1e-20f));
    p.facets *= scale;
    p.cosine *= scale;
    p.thin *= scale;
    p.thin_cosine *= scale;
    p.coat *= scale;
    p.sheen *= scale;
    return p;
}

/* D G cos wi / (4 cos wo cos wi) of GGX, and the density with which rt_visible_normal() finds wi. wo.z, wi.z > 0. */
RT_INLINE vfloat rt_facets_seen(rt_vec wo, rt_vec wi, rt_facets rough, vfloat *density)
{
    const vfloat smith_o = rt_smith(wo, &rough), smith_i = rt_smith(wi, &rough);
    const vfloat seen = rt_facets_along(rt_add(wo, wi), &rough) / (rt_vfloat(2.0f) * rt_max(wo.z, rt_vfloat(1e-6f)));
    *density = seen / (rt_vfloat(1.0f) + smith_o);
    return seen / (smith_o + smith_i);
}

#if RT_MAY_SCATTER(RT_LOBE_COAT)
/* A direction in the frame of the varnish's normal, and back. */
RT_INLINE rt_vec rt_to_coat(const rt_layered *l, rt_vec w)
{
    rt_vec s, t;
    rt_basis(l->coat_normal, &s, &t);
    return rt_to_local(s, t, l->coat_normal, w);
}
RT_INLINE rt_vec rt_from_coat(const rt_layered *l, rt_vec w)
{
    rt_vec s, t;
    rt_basis(l->coat_normal, &s, &t);
    return rt_to_world(s, t, l->coat_normal, w);
}
#endif

/* f |cos wi| of the lanes of the model, without smooth facets. inside: of the solid glass below. pdf: with which rt_layers_draw() finds
 * wi. */
RT_CALLED rt_vec rt_layers_eval(const rt_layered *l, const rt_layer_lobes *p, rt_vec wo, rt_vec wi, rt_vec inside, vfloat *pdf)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_aspect *o = &p->from;
    const rt_aspect i = rt_aspect_of(l, wi);
    const vmask above = RT_MASK(wi.z > zero);
    const vfloat cosine = rt_vfloat(RT_INVERSE_PI) * fabs(wi.z);
    const vfloat mirror_dim = rt_below_all(l, o, &i, l->facets.alpha), spread_dim = rt_below_all(l, o, &i, one);
    rt_vec f = rt_scale(RT_MAY_SCATTER(RT_LOBE_GLASS) ? rt_select(above, mirror_dim, rt_below_through(o, &i)) : mirror_dim, inside);

    /* What is diffuse below the facets, and light that several facets scatter. */
    const vfloat again = o->lost * i.lost / rt_max(l->lost_mean, rt_vfloat(1e-9f));
    const vfloat under = l->diffuse * l->inside * (one - o->gloss) * (one - i.gloss);
    rt_vec spread = rt_scale(under, l->color);
    spread = rt_along(again * l->metal, l->metal_again, rt_along(again * l->gloss, l->gloss_again, spread));
    *pdf = p->cosine * cosine;
    if (RT_MAY_SCATTER(RT_LOBE_THIN)) {
        spread = rt_choose(above, spread, rt_scale(again * l->thin, rt_mul(l->color, rt_rest(l->gloss_again))));
        *pdf = rt_select(above, p->cosine, p->thin_cosine) * cosine;
    } else {
        spread = rt_scale(rt_select(above, one, zero), spread);
        *pdf = rt_select(above, *pdf, zero);
    }
    f = rt_along(cosine * spread_dim, spread, f);

    /* Facets: mirrored light, and light through a sheet as if the sheet mirrored it to the other side. */
    const vmask rough = RT_MASK(l->facets.alpha > zero) & (RT_MAY_SCATTER(RT_LOBE_THIN) ? rt_vint(-1) : above);
    if (rt_any(rough)) {
        const rt_vec mirrored = rt_vec_of(wi.x, wi.y, fabs(wi.z));
        const vfloat to_facet = rt_dot(wo, rt_normalize(rt_add(wo, mirrored)));
        vfloat density;
        const vfloat seen = rt_facets_seen(wo, mirrored, rt_rough_facets(&l->facets), &density);
        const rt_vec gloss = rt_gloss_fresnel(l, to_facet);
        rt_vec value = rt_along(l->gloss, gloss, rt_scale(l->metal, rt_metal_fresnel(l, to_facet)));
        if (RT_MAY_SCATTER(RT_LOBE_THIN)) value = rt_choose(above, value, rt_scale(l->thin, rt_mul(l->color, rt_rest(gloss))));
        f = rt_choose(rough, rt_along(seen * mirror_dim, value, f), f);
        *pdf = rt_select(rough, fma(rt_select(above, p->facets, p->thin), density, *pdf), *pdf);
    }
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    if (rt_any(above & RT_MASK(rt_largest(l->sheen) > zero))) {
        const vfloat value = rt_sheen_value(wo, rt_vec_of(wi.x, wi.y, fabs(wi.z)), l->sheen_roughness);
        f = rt_choose(above, rt_along(value * rt_below_coat(l, o, &i, one), l->sheen, f), f);
        *pdf = rt_select(above, fma(p->sheen, rt_vfloat(0.5f * RT_INVERSE_PI), *pdf), *pdf);
    }
#endif
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    const rt_vec coat_o = rt_to_coat(l, wo), coat_i = rt_to_coat(l, wi);
    const vmask coated = above & RT_MASK(l->coat_alpha > zero) & RT_MASK(coat_o.z > zero) & RT_MASK(coat_i.z > zero);
    if (rt_any(coated)) {
        vfloat density;
        const vfloat seen = l->coat * rt_facets_seen(coat_o, coat_i, rt_even_facets(rt_max(l->coat_alpha, rt_vfloat(RT_LEAST_ALPHA))), &density);
        const vfloat value = seen * rt_coat_fresnel(rt_dot(coat_o, rt_normalize(rt_add(coat_o, coat_i))));
        f = rt_choose(coated, rt_along(value * wi.z / coat_i.z, rt_splat(1.0f, 1.0f, 1.0f), f), f);
        *pdf = rt_select(coated, fma(p->coat, density, *pdf), *pdf);
    }
#endif
    return f;
}

/* A direction that was drawn; its z is 0 if there is none, below 0 if it goes through the sheet. weight and pdf: of smooth facets, for which `delta` is set; else rt_layers_eval() has them. */
typedef struct rt_layers_sample {
    rt_vec wi, weight;
    vfloat pdf;
    vmask delta;
} rt_layers_sample;

RT_INLINE rt_layers_sample rt_layers_draw(const rt_layered *l, const rt_layer_lobes *p, rt_vec wo, vfloat u_lobe, vfloat u1, vfloat u2)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), two = rt_vfloat(2.0f), least = rt_vfloat(RT_LEAST_ALPHA);
    rt_layers_sample s;
    /* The lobes' probabilities lie on a line in the order of rt_layer_lobes. */
    vfloat end = p->cosine;
    const vmask cosine = RT_MASK(u_lobe < end);
    vmask left = ~cosine;
    end += p->facets;
    const vmask facets = left & RT_MASK(u_lobe < end);
    left &= ~facets;
    vmask thin = rt_vint(0);

    s.wi = rt_warp_cosine(u1, u2);
    s.weight = rt_splat(0.0f, 0.0f, 0.0f);
    s.pdf = zero;
    s.delta = rt_vint(0);
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    end += p->coat;
    const vmask coat = left & RT_MASK(u_lobe < end);
    left &= ~coat;
    if (rt_any(coat)) {
        const rt_vec o = rt_to_coat(l, wo);
        const rt_vec h = rt_warp_visible_normal(o, rt_max(l->coat_alpha, least), rt_max(l->coat_alpha, least), u1, u2);
        const vmask smooth = RT_MASK(l->coat_alpha <= zero);
        const rt_vec facet = rt_choose(smooth, rt_splat(0.0f, 0.0f, 1.0f), h);
        const rt_vec i = rt_sub(rt_scale(two * rt_dot(o, facet), facet), o);
        rt_vec wi = rt_from_coat(l, i);
        wi.z = rt_select(RT_MASK(o.z > zero) & RT_MASK(i.z > zero), rt_max(wi.z, zero), zero);
        s.wi = rt_choose(coat, wi, s.wi);
        s.delta |= coat & smooth;
        const vfloat weight = l->coat * rt_coat_fresnel(o.z) * s.wi.z / rt_max(o.z * p->coat, rt_vfloat(1e-20f));
        s.weight = rt_choose(coat & smooth, rt_vec_of(weight, weight, weight), s.weight);
        s.pdf = rt_select(coat & smooth, p->coat, s.pdf);
    }
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    end += p->sheen;
    const vmask sheen = left & RT_MASK(u_lobe < end);
    left &= ~sheen;
    if (rt_any(sheen)) s.wi = rt_choose(sheen, rt_warp_cone(u1, u2, one), s.wi);
#endif
#if RT_MAY_SCATTER(RT_LOBE_THIN)
    end += p->thin;
    thin = left & RT_MASK(u_lobe < end);
    left &= ~thin;
    s.wi.z = rt_select(left, -s.wi.z, s.wi.z); /* thin_cosine */
#endif
    if (rt_any(facets | thin)) {
        const rt_facets rough = rt_rough_facets(&l->facets);
        const rt_vec h = rt_visible_normal(wo, &rough, u1, u2);
        const vmask smooth = RT_MASK(l->facets.alpha <= zero);
        const rt_vec facet = rt_choose(smooth, rt_splat(0.0f, 0.0f, 1.0f), h);
        const vfloat to_facet = rt_dot(wo, facet);
        rt_vec wi = rt_sub(rt_scale(two * to_facet, facet), wo);
        wi.z = rt_max(wi.z, zero); /* below 0 it meets a second facet */
        const rt_vec gloss = rt_gloss_fresnel(l, to_facet);
        rt_vec weight = rt_along(l->gloss, gloss, rt_scale(l->metal, rt_metal_fresnel(l, to_facet)));
        vfloat chance = p->facets;
        if (RT_MAY_SCATTER(RT_LOBE_THIN)) {
            wi.z = rt_select(thin, -wi.z, wi.z);
            weight = rt_choose(thin, rt_scale(l->thin, rt_mul(l->color, rt_rest(gloss))), weight);
            chance = rt_select(thin, p->thin, chance);
        }
        s.wi = rt_choose(facets | thin, wi, s.wi);
        const vmask mirrored = (facets | thin) & smooth;
        const vfloat dim = p->below / rt_max(chance, rt_vfloat(1e-20f));
        s.delta |= mirrored;
        s.weight = rt_choose(mirrored, rt_scale(dim, weight), s.weight);
        s.pdf = rt_select(mirrored, chance, s.pdf);
    }
    return s;
}

#endif
#endif
