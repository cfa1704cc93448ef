/* layers.h -- RT_MODEL_GLTF for the path tracer: varnish over fibres over facets, and below these metal, or a diffuse or clear inside.
 *
 * Khronos, glTF 2.0, appendix B, and KHR_materials_clearcoat, _sheen, _specular, _transmission. Where these dim what is below a layer by
 * one direction only, or lose light between facets, this one keeps light and is reciprocal: what is lost between facets comes back
 * (Kulla and Conty 2017, Revisiting Physically Based Shading at Imageworks), and a layer dims by both directions (rt_below). Solid glass
 * is a lobe of bsdf.h, which the layers dim. */
#ifndef RT_LAYERS_H
#define RT_LAYERS_H
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)

#define RT_COAT_STRAIGHT 0.04f /* reflectance of varnish of ior 1.5 */
#define RT_GRAZING_COSINES 40
#define RT_GRAZING_ROUGHNESSES 24
#define RT_LIKENESS 0.95f /* correlation of two layers' albedos over the hemisphere */

typedef struct rt_layered {
    vmask lanes;          /* the surface has the model */
    vmask sheet;          /* what goes through it stays in the same medium */
    rt_vec color;         /* of the metal, and of what is below the facets of the rest */
    vfloat alpha;         /* of the facets; 0: smooth. With a grain its mean */
    vfloat metal, gloss;  /* shares: of metal, and of the rest that reflects as a dielectric and is no solid glass */
    vfloat diffuse, thin; /* of gloss: what is below is diffuse, or light goes straight through */
    rt_vec straight;      /* reflectance of gloss, straight on */
    vfloat most, grazing; /* the largest channel of it; its reflectance at grazing angles */
    vfloat lost_mean; /* the mean over the hemisphere of what rt_aspect has for a direction */
    vfloat inside;    /* what is diffuse below gives back 1 with (1 - gloss)(1 - gloss') inside and layers of these means */
    rt_vec metal_again, gloss_again; /* share of the facets' lost light that comes back */
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    vfloat coat, coat_alpha, coat_mean;
    rt_vec coat_normal;
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    rt_vec sheen;
    vfloat sheen_roughness, sheen_mean;
#endif
} rt_layered;

/* What the layers do with light of one direction. */
typedef struct rt_aspect {
    vfloat lost, bent;  /* of facets: the loss with F = 1, and the albedo with F = (1 - cos)^5 */
    vfloat gloss;       /* albedo of gloss, light of several facets included */
    vfloat coat, sheen; /* albedos of these layers */
} rt_aspect;

/* The probabilities of draws. Their sum is 1, or 0 of a black surface. */
typedef struct rt_layer_lobes {
    vfloat cosine, facets, coat, sheen, thin, thin_cosine;
    vfloat albedo; /* by which they were divided */
    vfloat below;  /* by which the layers dim solid glass, for the choice */
    rt_aspect from;
} rt_layer_lobes;

/* The share of the light that facets lose which comes back from further ones, if F is `mean` and the loss `lost` on average. */
RT_INLINE vfloat rt_again(vfloat mean, vfloat lost)
{
    const vfloat one = rt_vfloat(1.0f);
    return mean * mean * (one - lost) / rt_max(one - mean * lost, rt_vfloat(1e-6f));
}
/* The mean of Schlick's reflectance over the hemisphere. */
RT_INLINE vfloat rt_schlick_mean(vfloat straight, vfloat grazing) { return fma(straight, rt_vfloat(20.0f / 21.0f), grazing * rt_vfloat(1.0f / 21.0f)); }
RT_INLINE rt_vec rt_again_of(rt_vec straight, vfloat grazing, vfloat lost)
{
    return rt_vec_of(rt_again(rt_schlick_mean(straight.x, grazing), lost), rt_again(rt_schlick_mean(straight.y, grazing), lost),
                     rt_again(rt_schlick_mean(straight.z, grazing), lost));
}
RT_INLINE vfloat rt_schlick_weight(vfloat cosine)
{
    const vfloat c = rt_max(rt_vfloat(1.0f) - cosine, rt_vfloat(0.0f)), c2 = c * c;
    return c2 * c2 * c;
}
RT_INLINE rt_vec rt_schlick(rt_vec straight, vfloat grazing, vfloat weight)
{
    return rt_vec_of(rt_mix(straight.x, grazing, weight), rt_mix(straight.y, grazing, weight), rt_mix(straight.z, grazing, weight));
}
RT_INLINE rt_vec rt_rest(rt_vec v)
{
    const vfloat one = rt_vfloat(1.0f);
    return rt_vec_of(one - v.x, one - v.y, one - v.z);
}

/* The albedo of facets with F = (1 - cos)^5, and its mean over the hemisphere. */
RT_CALLED vfloat rt_grazing(vfloat mu, vfloat alpha)
{
    const rt_between c = rt_between_nodes(rt_vfloat(0.5f) * (rt_facet_axis(mu, alpha) + mu), RT_GRAZING_COSINES);
    const rt_between r = rt_between_nodes(sqrt(alpha), RT_GRAZING_ROUGHNESSES);
    const vint first = c.low * rt_vint(RT_GRAZING_ROUGHNESSES) + r.low;
    return rt_mix(rt_from_pair(rt_albedo_grazing, first, r.share),
                  rt_from_pair(rt_albedo_grazing, first + rt_vint(RT_GRAZING_ROUGHNESSES), r.share), c.share);
}
RT_INLINE vfloat rt_grazing_mean(vfloat alpha)
{
    const rt_between r = rt_between_nodes(sqrt(alpha), 2 * RT_GRAZING_ROUGHNESSES - 1);
    return rt_from_pair(rt_albedo_grazing_mean, r.low, r.share);
}
RT_INLINE vfloat rt_grazing_deviation(vfloat alpha)
{
    const rt_between r = rt_between_nodes(sqrt(alpha), RT_GRAZING_ROUGHNESSES);
    return rt_from_pair(rt_albedo_grazing_deviation, r.low, r.share);
}
/* The albedo of facets by what they lose and bend. */
RT_INLINE vfloat rt_facets_albedo(vfloat straight, vfloat grazing, vfloat lost, vfloat bent)
{
    return fma(straight, rt_max(rt_vfloat(1.0f) - lost - bent, rt_vfloat(0.0f)), grazing * bent);
}

RT_CALLED rt_aspect rt_aspect_of(const rt_layered *l, rt_vec w)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), mu = rt_min(fabs(w.z), one);
    rt_aspect a;
    a.lost = rt_lost_by_metal(mu, l->alpha);
    a.bent = rt_grazing(mu, l->alpha);
    a.gloss = fma(a.lost, rt_again(rt_schlick_mean(l->most, l->grazing), l->lost_mean), rt_facets_albedo(l->most, l->grazing, a.lost, a.bent));
    a.coat = a.sheen = zero;
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    const vfloat coat_mu = rt_min(fabs(rt_dot(w, l->coat_normal)), one);
    a.coat = l->coat * rt_facets_albedo(rt_vfloat(RT_COAT_STRAIGHT), one, rt_lost_by_metal(coat_mu, l->coat_alpha), rt_grazing(coat_mu, l->coat_alpha));
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    a.sheen = rt_largest(l->sheen) * rt_sheen_albedo(mu, l->sheen_roughness);
#endif
    return a;
}

/* The means that depend on the surface alone. */
RT_CALLED void rt_prepare_layers(rt_layered *l)
{
    const vfloat one = rt_vfloat(1.0f), least = rt_vfloat(1e-6f);
    l->most = rt_largest(l->straight);
    l->lost_mean = rt_lost_by_metal_mean(l->alpha);
    l->metal_again = rt_again_of(l->color, one, l->lost_mean);
    l->gloss_again = rt_again_of(l->straight, l->grazing, l->lost_mean);
    const vfloat gloss_mean = fma(l->lost_mean, rt_largest(l->gloss_again), rt_facets_albedo(l->most, l->grazing, l->lost_mean, rt_grazing_mean(l->alpha)));
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    l->coat_mean = l->coat * rt_facets_albedo(rt_vfloat(RT_COAT_STRAIGHT), one, rt_lost_by_metal_mean(l->coat_alpha), rt_grazing_mean(l->coat_alpha));
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    l->sheen_mean = rt_largest(l->sheen) * rt_sheen_albedo_mean(l->sheen_roughness);
#endif
    /* The mean of a product is more than that of the means, as all reflect most at grazing angles. */
    const vfloat gloss = (l->grazing - l->most) * rt_grazing_deviation(l->alpha) / rt_max(one - gloss_mean, least);
    vfloat sum = gloss, squares = gloss * gloss;
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    const vfloat coat = l->coat * rt_grazing_deviation(l->coat_alpha) / rt_max(one - l->coat_mean, least);
    sum += coat;
    squares = fma(coat, coat, squares);
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    const vfloat sheen = rt_largest(l->sheen) * rt_sheen_albedo_deviation(l->sheen_roughness) / rt_max(one - l->sheen_mean, least);
    sum += sheen;
    squares = fma(sheen, sheen, squares);
#endif
    l->inside = one / (rt_max(one - gloss_mean, least) * fma(rt_vfloat(0.5f * RT_LIKENESS), fma(sum, sum, -squares), one));
}

RT_INLINE vfloat rt_alpha_of(vfloat roughness)
{
    const vfloat zero = rt_vfloat(0.0f), alpha = roughness * roughness;
    return rt_select(RT_MASK(alpha > zero), rt_max(alpha, rt_vfloat(RT_LEAST_ALPHA)), zero);
}

/* The layers of all lanes. lanes: those with the model. around: ior outside of the surface. */
RT_INLINE rt_layered rt_layered_of(const rt_matter *m, vmask lanes, vfloat around)
{
    const vfloat one = rt_vfloat(1.0f), other = one - m->metallic, clear = other * m->transmission;
    const vfloat mirrored = (m->ior - around) / (m->ior + around), straight = m->specular_weight * mirrored * mirrored;
    rt_layered l;
    l.lanes = lanes;
    l.sheet = lanes & ~m->solid;
    l.color = m->color;
    l.alpha = rt_alpha_of(m->roughness);
    l.metal = m->metallic;
    l.gloss = rt_select(m->solid, other - clear, other);
    l.diffuse = other - clear;
    l.thin = rt_select(m->solid, rt_vfloat(0.0f), clear);
    l.grazing = m->specular_weight;
    l.straight = rt_vec_of(rt_min(straight * m->specular_color.x, l.grazing), rt_min(straight * m->specular_color.y, l.grazing),
                           rt_min(straight * m->specular_color.z, l.grazing));
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    l.coat = m->clearcoat;
    l.coat_alpha = rt_alpha_of(m->clearcoat_roughness);
    l.coat_normal = m->coat_normal;
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    l.sheen = m->sheen_color;
    l.sheen_roughness = m->sheen_roughness;
#endif
    rt_prepare_layers(&l);
    return l;
}

/* By what a layer dims light, with the albedos x_o and x_i in its two directions and x_mean over the hemisphere. What is below it mirrors
 * light (spread = 0) or spreads it by the cosine (1); either way all light is kept that the layer does not reflect. */
RT_INLINE vfloat rt_below(vfloat x_o, vfloat x_i, vfloat x_mean, vfloat spread)
{
    const vfloat one = rt_vfloat(1.0f), both = rt_max((one - x_o) * (one - x_i), rt_vfloat(0.0f));
    return rt_mix(sqrt(both), both / rt_max(one - x_mean, rt_vfloat(1e-6f)), spread);
}
RT_INLINE vfloat rt_below_coat(const rt_layered *l, const rt_aspect *o, const rt_aspect *i, vfloat spread)
{
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    return rt_below(o->coat, i->coat, l->coat_mean, spread);
#else
    return rt_vfloat(1.0f);
#endif
}
RT_INLINE vfloat rt_below_all(const rt_layered *l, const rt_aspect *o, const rt_aspect *i, vfloat spread)
{
    vfloat dim = rt_below_coat(l, o, i, spread);
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    dim *= rt_below(o->sheen, i->sheen, l->sheen_mean, spread);
#endif
    return dim;
}

RT_INLINE rt_layer_lobes rt_layer_lobes_of(const rt_layered *l, rt_vec wo)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_layer_lobes p;
    p.from = rt_aspect_of(l, wo);
    const rt_aspect *a = &p.from;
    const vfloat color = rt_largest(l->color), gloss = rt_facets_albedo(l->most, l->grazing, a->lost, a->bent);
    const vfloat metal_again = rt_largest(l->metal_again), gloss_again = rt_largest(l->gloss_again);
    p.below = (one - a->coat) * (one - a->sheen);
    p.facets = p.below * fma(l->metal, rt_facets_albedo(color, one, a->lost, a->bent), l->gloss * gloss);
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

/* Reflectances for light that meets a facet with that cosine. */
RT_INLINE rt_vec rt_metal_fresnel(const rt_layered *l, vfloat cosine) { return rt_schlick(l->color, rt_vfloat(1.0f), rt_schlick_weight(cosine)); }
RT_INLINE rt_vec rt_gloss_fresnel(const rt_layered *l, vfloat cosine) { return rt_schlick(l->straight, l->grazing, rt_schlick_weight(cosine)); }
RT_INLINE vfloat rt_coat_fresnel(vfloat cosine) { return rt_mix(rt_vfloat(RT_COAT_STRAIGHT), rt_vfloat(1.0f), rt_schlick_weight(cosine)); }

/* D G cos wi / (4 cos wo cos wi) of GGX, and the density with which rt_warp_visible_normal() finds wi. wo.z, wi.z > 0. */
RT_INLINE vfloat rt_facets_seen(rt_vec wo, rt_vec wi, vfloat alpha, vfloat *density)
{
    const vfloat smith_o = rt_smith(wo.z, alpha), smith_i = rt_smith(wi.z, alpha);
    const vfloat seen = rt_facets_along(rt_add(wo, wi), alpha) / (rt_vfloat(2.0f) * rt_max(wo.z, rt_vfloat(1e-6f)));
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
    const vfloat mirror_dim = rt_below_all(l, o, &i, l->alpha), spread_dim = rt_below_all(l, o, &i, one);
    rt_vec f = rt_scale(mirror_dim, inside);

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
    const vmask rough = RT_MASK(l->alpha > zero) & (RT_MAY_SCATTER(RT_LOBE_THIN) ? rt_vint(-1) : above);
    if (rt_any(rough)) {
        const vfloat alpha = rt_max(l->alpha, rt_vfloat(RT_LEAST_ALPHA));
        const rt_vec mirrored = rt_vec_of(wi.x, wi.y, fabs(wi.z));
        const vfloat to_facet = rt_dot(wo, rt_normalize(rt_add(wo, mirrored)));
        vfloat density;
        const vfloat seen = rt_facets_seen(wo, mirrored, alpha, &density);
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
        const vfloat seen = l->coat * rt_facets_seen(coat_o, coat_i, rt_max(l->coat_alpha, rt_vfloat(RT_LEAST_ALPHA)), &density);
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
        const rt_vec h = rt_warp_visible_normal(o, rt_max(l->coat_alpha, least), u1, u2);
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
        const rt_vec h = rt_warp_visible_normal(wo, rt_max(l->alpha, least), u1, u2);
        const vmask smooth = RT_MASK(l->alpha <= zero);
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
