/* layers.h -- RT_MODEL_GLTF for the path tracer: varnish over fibres over facets, and below these metal, or a diffuse or clear inside.
 *
 * Khronos, glTF 2.0, appendix B, and KHR_materials_clearcoat, _sheen, _specular, _transmission. Where these dim what is below a layer by
 * one direction only, or lose light between facets, this one keeps light and is reciprocal: what is lost between facets comes back
 * (Kulla and Conty 2017, Revisiting Physically Based Shading at Imageworks), and a layer dims by both directions (rt_below). Solid glass
 * is a lobe of bsdf.h, which the layers dim; its reflectance is rt_glass_fresnel(). */
#ifndef RT_LAYERS_H
#define RT_LAYERS_H
#if RT_MAY_SCATTER(RT_LOBE_LAYERS)

#define RT_COAT_STRAIGHT 0.04f /* reflectance of varnish of ior 1.5 */
#define RT_GRAZING_COSINES 40
#define RT_GRAZING_ROUGHNESSES 24
#define RT_MEAN_COSINE 0.667f
#define RT_LIKENESS 0.95f /* correlation of two layers' albedos over the hemisphere */

typedef struct rt_layered {
    vmask lanes;          /* the surface has the model */
    vmask sheet;          /* what goes through it stays in the same medium */
    rt_vec color;         /* of the metal, and of what is below the facets of the rest */
    rt_facets facets;
    vfloat metal, gloss;  /* shares: of metal, and of the rest that reflects as a dielectric and is no solid glass */
    vfloat diffuse, thin; /* of gloss: what is below is diffuse, or light goes straight through */
    rt_vec straight;      /* reflectance of gloss, straight on */
    vfloat most, grazing; /* the largest channel of it; its reflectance at grazing angles */
    vfloat lost_mean; /* the mean over the hemisphere of what rt_aspect has for a direction */
    vfloat inside;    /* what is diffuse below gives back 1 with (1 - gloss)(1 - gloss') inside and layers of these means */
    rt_vec metal_again, gloss_again; /* share of the facets' lost light that comes back */
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
    vmask changed; /* the lanes with glass that reflects less or more than Fresnel's equations say */
    vfloat glass_mean;               /* mean reflectance of solid glass, from its thinner side */
    vfloat glass_weak, glass_mirror; /* see rt_change_lost() */
#endif
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    vfloat coat, coat_alpha, coat_mean;
    rt_vec coat_normal;
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    rt_vec sheen;
    vfloat sheen_roughness, sheen_mean;
#endif
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    vfloat film, film_ior, film_nm; /* share that has it, and its thickness */
#endif
} rt_layered;

/* What the layers do with light of one direction. */
typedef struct rt_aspect {
    vfloat lost, bent;  /* of facets: the loss with F = 1, and the albedo with F = (1 - cos)^5 */
    vfloat gloss;       /* albedo of gloss, light of several facets included */
    vfloat coat, sheen; /* albedos of these layers */
} rt_aspect;

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
RT_INLINE rt_vec rt_schlick(rt_vec straight, vfloat grazing, vfloat weight)
{
    return rt_vec_of(rt_mix(straight.x, grazing, weight), rt_mix(straight.y, grazing, weight), rt_mix(straight.z, grazing, weight));
}
RT_INLINE rt_vec rt_rest(rt_vec v)
{
    const vfloat one = rt_vfloat(1.0f);
    return rt_vec_of(one - v.x, one - v.y, one - v.z);
}

/* Reflectances for light that meets a facet with that cosine. */
RT_INLINE rt_vec rt_metal_fresnel(const rt_layered *l, vfloat cosine)
{
    const rt_vec bare = rt_schlick(l->color, rt_vfloat(1.0f), rt_schlick_weight(cosine));
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    return rt_along(l->film, rt_sub(rt_film(cosine, l->film_ior, l->film_nm, l->color), bare), bare);
#else
    return bare;
#endif
}
/* Of what is no metal. weight: 0 straight on, 1 at grazing angles. */
RT_INLINE rt_vec rt_weighted_fresnel(const rt_layered *l, vfloat cosine, vfloat weight)
{
    const rt_vec bare = rt_schlick(l->straight, l->grazing, weight);
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    const rt_vec full = rt_scale(rt_vfloat(1.0f) / rt_max(l->grazing, rt_vfloat(1e-6f)), l->straight);
    return rt_along(l->film, rt_sub(rt_scale(l->grazing, rt_film(cosine, l->film_ior, l->film_nm, full)), bare), bare);
#else
    return bare;
#endif
}
RT_INLINE rt_vec rt_gloss_fresnel(const rt_layered *l, vfloat cosine) { return rt_weighted_fresnel(l, cosine, rt_schlick_weight(cosine)); }
RT_INLINE vfloat rt_coat_fresnel(vfloat cosine) { return rt_mix(rt_vfloat(RT_COAT_STRAIGHT), rt_vfloat(1.0f), rt_schlick_weight(cosine)); }
/* An albedo of facets, which is `bare` without a film. With one all facets are taken for those met with the cosine mu. */
RT_INLINE vfloat rt_filmed(const rt_layered *l, rt_vec fresnel, vfloat lost, vfloat bare)
{
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    return rt_select(RT_MASK(l->film > rt_vfloat(0.0f)), rt_largest(fresnel) * (rt_vfloat(1.0f) - lost), bare);
#else
    return bare;
#endif
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

#if RT_MAY_SCATTER(RT_LOBE_COAT)
/* The albedo of varnish, for light with the cosine mu to its normal. */
RT_INLINE vfloat rt_coat_albedo(vfloat coat, vfloat alpha, vfloat mu)
{
    return coat * rt_facets_albedo(rt_vfloat(RT_COAT_STRAIGHT), rt_vfloat(1.0f), rt_lost_by_metal(mu, alpha), rt_grazing(mu, alpha));
}
#endif

RT_CALLED rt_aspect rt_aspect_of(const rt_layered *l, rt_vec w)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), mu = rt_min(fabs(w.z), one);
    rt_aspect a;
    a.lost = rt_lost_by_metal(mu, rt_even_alpha(&l->facets, w, RT_SWING_OF_LOSS));
    a.bent = rt_grazing(mu, rt_even_alpha(&l->facets, w, RT_SWING_OF_GRAZING));
    const vfloat gloss = rt_filmed(l, rt_gloss_fresnel(l, mu), a.lost, rt_facets_albedo(l->most, l->grazing, a.lost, a.bent));
    a.gloss = fma(a.lost, rt_largest(l->gloss_again), gloss);
    a.coat = a.sheen = zero;
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    a.coat = rt_coat_albedo(l->coat, l->coat_alpha, rt_min(fabs(rt_dot(w, l->coat_normal)), one));
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    a.sheen = rt_largest(l->sheen) * rt_sheen_albedo(mu, l->sheen_roughness);
#endif
    return a;
}

#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
/* For glass that reflects less or more than by Fresnel's equations. straight: by these, straight on. */
RT_INLINE void rt_prepare_glass(rt_layered *l, vfloat n, vfloat straight)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), third = rt_vfloat(1.0f / 3.0f);
    const vfloat own = third * (l->straight.x + l->straight.y + l->straight.z), rest = rt_max(one - straight, rt_vfloat(1e-6f));
    const rt_vec seen = rt_gloss_fresnel(l, rt_vfloat(RT_MEAN_COSINE));
    l->glass_mean = rt_mix(own, l->grazing, rt_max(rt_glass_mean(n) - straight, zero) / rest);
    l->glass_mirror = rt_min(rt_max(third * (seen.x + seen.y + seen.z) - l->grazing * straight, zero) / rest, one);
    /* Our fit, within 0.03 for indices from 1.2 to 2.4, of how much is lost of light from the thinner side when nothing is mirrored. */
    const vfloat root = (n - one) / (n + one), most = root / (root + rt_vfloat(0.74f));
    const vfloat power = rt_power(rt_max(l->facets.alpha, rt_vfloat(1e-6f)), fma(rt_vfloat(1.15f), root, rt_vfloat(1.2f)));
    l->glass_weak = rt_mix(power / (power + rt_max(most, rt_vfloat(1e-6f))), one, l->grazing);
}
#endif

/* The means that depend on the surface alone. */
RT_CALLED void rt_prepare_layers(rt_layered *l)
{
    const vfloat one = rt_vfloat(1.0f), least = rt_vfloat(1e-6f);
    l->most = rt_largest(l->straight);
    l->lost_mean = rt_lost_by_metal_mean(l->facets.alpha);
    l->metal_again = rt_again_of(l->color, one, l->lost_mean);
    l->gloss_again = rt_again_of(l->straight, l->grazing, l->lost_mean);
    const vfloat gloss_mean = fma(l->lost_mean, rt_largest(l->gloss_again), rt_filmed(l, rt_gloss_fresnel(l, rt_vfloat(RT_MEAN_COSINE)), l->lost_mean,
                                                                                                        rt_facets_albedo(l->most, l->grazing, l->lost_mean, rt_grazing_mean(l->facets.alpha))));
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    l->coat_mean = l->coat * rt_facets_albedo(rt_vfloat(RT_COAT_STRAIGHT), one, rt_lost_by_metal_mean(l->coat_alpha), rt_grazing_mean(l->coat_alpha));
#endif
#if RT_MAY_SCATTER(RT_LOBE_SHEEN)
    l->sheen_mean = rt_largest(l->sheen) * rt_sheen_albedo_mean(l->sheen_roughness);
#endif
    /* The mean of a product is more than that of the means, as all reflect most at grazing angles. */
    const vfloat gloss = (l->grazing - l->most) * rt_grazing_deviation(l->facets.alpha) / rt_max(one - gloss_mean, least);
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

#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
/* What solid glass reflects that reflects `exact` by Fresnel's equations: as KHR_materials_specular and _iridescence change it. eta: ior of
 * the other side / ior of this side. cosine: on the thinner side. */
RT_INLINE rt_vec rt_glass_fresnel(const rt_layered *l, vfloat exact, vfloat eta, vfloat cosine)
{
    const vfloat one = rt_vfloat(1.0f), root = (eta - one) / (eta + one), straight = root * root;
    const vfloat weight = rt_max(exact - straight, rt_vfloat(0.0f)) / rt_max(one - straight, rt_vfloat(1e-6f));
    const rt_vec changed = rt_weighted_fresnel(l, cosine, weight);
    /* Total reflection stays: there is no way into the other side. */
    return rt_choose(l->changed & RT_MASK(exact < one), changed, rt_vec_of(exact, exact, exact));
}
#endif

RT_INLINE vfloat rt_alpha_of(vfloat roughness)
{
    const vfloat zero = rt_vfloat(0.0f), alpha = roughness * roughness;
    return rt_select(RT_MASK(alpha > zero), rt_max(alpha, rt_vfloat(RT_LEAST_ALPHA)), zero);
}

#if RT_MAY_SCATTER(RT_LOBE_COAT)
/* The share of a surface's own light that varnish on it lets out. cosine: to the geometric normal, for the light that is drawn knows no
 * other. */
RT_INLINE vfloat rt_through_coat(vfloat coat, vfloat alpha, vfloat cosine)
{
    const vfloat one = rt_vfloat(1.0f);
    return one - rt_coat_albedo(coat, alpha, rt_min(fabs(cosine), one));
}
#endif

/* The layers of all lanes. lanes: those with the model. around: ior outside of the surface. */
RT_INLINE rt_layered rt_layered_of(const rt_matter *m, vmask lanes, vfloat around)
{
    const vfloat one = rt_vfloat(1.0f), other = one - m->metallic, clear = other * m->transmission;
    const vfloat mirrored = (m->ior - around) / (m->ior + around), straight = m->specular_weight * mirrored * mirrored;
    rt_layered l;
    l.lanes = lanes;
    l.sheet = lanes & ~m->solid;
    l.color = m->color;
#if RT_MAY_SCATTER(RT_LOBE_GRAIN)
    l.facets = rt_grained_facets(rt_alpha_of(m->roughness), m->anisotropy, m->grain_x, m->grain_y);
#else
    l.facets = rt_even_facets(rt_alpha_of(m->roughness));
#endif
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
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    l.film = m->iridescence;
    l.film_ior = m->iridescence_ior;
    l.film_nm = m->iridescence_thickness;
#endif
    rt_prepare_layers(&l);
#if RT_MAY_SCATTER(RT_LOBE_CHANGED)
    const rt_vec tint = m->specular_color;
    l.changed = lanes & (RT_MASK(m->specular_weight != one) | RT_MASK(tint.x != one) | RT_MASK(tint.y != one) | RT_MASK(tint.z != one));
#if RT_MAY_SCATTER(RT_LOBE_FILM)
    l.changed |= lanes & RT_MASK(l.film > rt_vfloat(0.0f));
#endif
    rt_prepare_glass(&l, rt_max(m->ior / around, around / m->ior), mirrored * mirrored);
#endif
    return l;
}

/* By what the layers dim light that goes through a solid: as much as on the side where they reflect more, which is mostly that where light
 * leaves the solid. So it is the same both ways, and no more light comes out than goes in. */
RT_INLINE vfloat rt_below_through(const rt_aspect *o, const rt_aspect *i)
{
    const vfloat one = rt_vfloat(1.0f);
    return rt_max((one - rt_max(o->coat, i->coat)) * (one - rt_max(o->sheen, i->sheen)), rt_vfloat(0.0f));
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

#endif
#endif
