/* shading.h -- Whitted's model at the hit points of a packet: direct light with shadows, and the directions and shares of
 * mirrored and refracted rays.
 *
 * Whitted 1980, An Improved Illumination Model for Shaded Display; highlight by Blinn 1977. */
#ifndef RT_SHADING_H
#define RT_SHADING_H

/* Numbers of a work-item's rays: shadow rays, secondary rays, rays dropped for lack of room, and full traversal stacks. */
typedef struct rt_tally {
    uint shadow, secondary, dropped, overflow;
    RT_RECORD(rt_recorder recorder)
} rt_tally;

/* By what the colour of a light is multiplied for a surface at `at` that faces it. towards: unit vector to the light. Whitted's colour
 * is an irradiance divided by pi. A light with a size is taken for a point at its middle: its strength is exact on the axis of a
 * disc and outside of a sphere. */
RT_INLINE vfloat rt_light_strength(const global rt_light *light, rt_vec at, rt_vec towards)
{
    const vfloat zero = rt_vfloat(0.0f), least = rt_vfloat(1e-30f);
    const float by_pi = 0.31830989f;
    const uint kind = light->kind;
    const bool fades = (light->flags & RT_LIGHT_FALLOFF) != 0u, two_sided = (light->flags & RT_LIGHT_TWO_SIDED) != 0u;
    if (kind == RT_LIGHT_DIRECTIONAL || kind == RT_LIGHT_SUN) return rt_vfloat(kind == RT_LIGHT_SUN || fades ? by_pi : 1.0f);
    const rt_vec to = rt_sub(rt_spread(light->position), at);
    const vfloat squared = rt_dot(to, to), cosine = -rt_dot(rt_spread(light->normal), towards);
    if ((1u << kind & RT_LIGHTS_POINTS) != 0u) {
        const vfloat share = rt_intensity_share(rt_vint((int)kind), cosine, rt_vfloat(light->cos_inner), rt_vfloat(light->cos_outer));
        return fades ? share * rt_vfloat(by_pi) * rt_fall_off(squared, rt_vfloat(light->range)) : share;
    }
    const float radius2 = light->radius * light->radius;
    if (kind == RT_LIGHT_SPHERE) return rt_vfloat(radius2) / rt_max(squared, rt_vfloat(radius2));
    const vfloat side = rt_vfloat(light->area * by_pi * (two_sided ? 0.5f : 1.0f));
    return side * rt_max(two_sided ? fabs(cosine) : cosine, zero) / rt_max(squared + side, least);
}

/* The share of light that a surface sends back which is there in part. */
#ifdef RT_HAS_CUTOUTS
#define RT_COVERED(shade, light) rt_scale((shade)->coverage, light)
#else
#define RT_COVERED(shade, light) (light)
#endif

/* Computes the light that the points of `count` blocks send back along their rays: emission, ambient light, and every light that
 * is not in shadow. rays, hits: room for the shadow rays. sent: written for blocks in which something was hit. */
RT_INLINE void rt_direct_light(const rt_ctx *ctx, const constant rt_frame *frame, const rt_point *points, const rt_shade *materials,
                               uint count, rt_rays *rays, rt_hits *hits, rt_vec *sent, rt_tally *tally)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_vec diffuse[RT_STREAM], shine[RT_STREAM];
    RT_FOR_EACH_PACKET(b, count) {
        diffuse[b] = rt_splat(frame->ambient[0], frame->ambient[1], frame->ambient[2]);
#ifdef RT_HAS_MAPS
        if (rt_any(points[b].hits)) diffuse[b] = rt_scale(materials[b].occlusion, diffuse[b]);
#endif
        shine[b] = rt_splat(0.0f, 0.0f, 0.0f);
    }
    for (uint i = 0; i < frame->light_count; ++i) {
        const global rt_light *light = ctx->lights + i;
        vfloat cosines[RT_STREAM];
        uint asked[RT_STREAM], any_asked = 0;
        RT_RECORD(vfloat distances[RT_STREAM])
#ifdef RT_HAS_CUTOUTS
        vmask wanted[RT_STREAM];
        vfloat reach[RT_STREAM];
#endif
        RT_FOR_EACH_PACKET(b, count) {
            const rt_point *p = points + b;
            rt_rays *shadow = rays + b;
            asked[b] = 0u;
            if (!rt_any(p->hits)) {
                rt_clear_hits(hits + b, p->hits);
                continue;
            }
            const rt_vec above = rt_along(p->outward, p->geometric, p->at);
            rt_vec towards = rt_spread(light->position);
            vfloat distance = RT_INFINITY;
            if (!RT_MAY_SHINE(1u << RT_LIGHT_DIRECTIONAL | 1u << RT_LIGHT_SUN) || (light->kind != RT_LIGHT_DIRECTIONAL && light->kind != RT_LIGHT_SUN)) {
                towards = rt_sub(towards, above);
                const vfloat scale = rt_inverse_length(towards);
                distance = one / scale;
                towards = rt_scale(scale, towards);
            }
            cosines[b] = rt_dot(p->normal, towards);
            const vmask lit = p->hits & RT_MASK(cosines[b] > zero) & RT_MASK(rt_dot(p->geometric, towards) > zero);
            asked[b] = rt_bits(lit);
            any_asked |= asked[b];
#ifdef RT_HAS_CUTOUTS
            wanted[b] = lit;
            reach[b] = distance;
#endif
            shadow->ox = above.x;
            shadow->oy = above.y;
            shadow->oz = above.z;
            shadow->dx = towards.x;
            shadow->dy = towards.y;
            shadow->dz = towards.z;
            shadow->t_min = zero;
            RT_SEEN_BY(shadow, rt_vint(RT_SEEN_BY_SHADOW))
            rt_clear_hits(hits + b, lit);
            hits[b].t = rt_select(lit, distance, rt_vfloat(-1.0f));
            if (frame->shadows != 0u && asked[b] != 0u) {
                rt_prepare(shadow, asked[b]);
#ifdef RT_SPLITS_INCOHERENT
                shadow->incoherent = rt_incoherent(shadow, p->area, asked[b]);
#endif
            }
            RT_RECORD(distances[b] = distance)
        }
        if (any_asked == 0u) continue;
        if (frame->shadows != 0u) {
            rt_trace_stream_any(ctx, frame, rays, hits, count);
            RT_FOR_EACH_PACKET(b, count) {
                tally->shadow += popcount(asked[b]);
                RT_TALLY_OVERFLOW(tally, hits + b)
            }
        }
        RT_FOR_EACH_PACKET(b, count) {
            if (asked[b] == 0u) continue;
            const rt_point *p = points + b;
            const rt_shade *m = materials + b;
            vmask lit = RT_MASK(hits[b].t >= zero);
            const rt_vec towards = rt_vec_of(rays[b].dx, rays[b].dy, rays[b].dz);
            vfloat highlight = zero;
            if (rt_any(p->hits & RT_MASK(rt_largest(m->specular) > zero))) {
                const rt_vec half_way = rt_normalize(rt_sub(towards, p->incoming));
                highlight = rt_power(clamp(rt_dot(p->normal, half_way), zero, one), m->shininess);
            }
            rt_vec color = rt_spread(light->color);
#ifdef RT_HAS_CUTOUTS
            const vmask occluded = wanted[b] & ~lit;
            if (rt_any(occluded)) {
                const vfloat through = rt_light_through(ctx, frame, rays + b, occluded, reach[b], &tally->dropped);
                color = rt_scale(rt_select(occluded, through, one), color);
                lit |= occluded & RT_MASK(through > zero);
            }
#endif
            if (RT_MAY_SHINE(~RT_LIGHTS_PLAIN) && (light->kind > RT_LIGHT_DIRECTIONAL || light->flags != 0u))
                color = rt_scale(rt_light_strength(light, rt_vec_of(rays[b].ox, rays[b].oy, rays[b].oz), towards), color);
            diffuse[b] = rt_along(rt_select(lit, cosines[b], zero), color, diffuse[b]);
            shine[b] = rt_along(rt_select(lit, highlight, zero), color, shine[b]);
            RT_RECORD(rt_record_shadow(&tally->recorder, i, frame->shadows != 0u, asked[b], rt_bits(lit), rays + b, hits + b, distances[b],
                                       rt_reflected_light(m, rt_scale(cosines[b], color), rt_scale(highlight, color))))
        }
    }
    RT_FOR_EACH_PACKET(b, count)
        if (rt_any(points[b].hits))
            sent[b] = RT_COVERED(materials + b, rt_add(materials[b].emission, rt_reflected_light(materials + b, diffuse[b], shine[b])));
}

/* The shares of the light that come by the mirrored and by the refracted ray. */
typedef struct rt_split {
    vfloat mirrored, refracted;
    vfloat eta, cos_out; /* of the refracted ray, by Snell's law: sin out = eta sin in */
#ifdef RT_HAS_CUTOUTS
    vfloat tinted;       /* of `refracted` the share that the surface's colour tints; the rest passes beside the surface */
#endif
} rt_split;

/* Computes the shares by Fresnel's equations for unpolarised light. A refracted sine above 1 means total internal reflection. */
RT_INLINE rt_split rt_fresnel(const rt_point *p, const rt_shade *m)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_split s;
    s.eta = rt_select(p->leaving, m->ior, one / m->ior);
    const vfloat sin2_out = s.eta * s.eta * rt_max(one - p->cos_in * p->cos_in, zero);
    s.cos_out = sqrt(rt_max(one - sin2_out, zero));
    const vfloat across = (s.eta * p->cos_in - s.cos_out) / (s.eta * p->cos_in + s.cos_out);
    const vfloat along = (p->cos_in - s.eta * s.cos_out) / (p->cos_in + s.eta * s.cos_out);
    const vfloat fresnel = rt_select(RT_MASK(sin2_out >= one), one, 0.5f * (across * across + along * along));
    const vmask glass = RT_MASK(m->refract > zero);
    s.mirrored = m->reflect + rt_select(glass, m->refract * fresnel, zero);
    s.refracted = rt_select(glass, m->refract * (one - fresnel), zero);
#ifdef RT_HAS_CUTOUTS
    /* What is there in part shows what is behind it: light goes straight on, also that which glass would bend. */
    const vmask partly = RT_MASK(m->coverage < one);
    s.mirrored *= m->coverage;
    s.tinted = s.refracted * m->coverage;
    s.refracted = s.tinted + (one - m->coverage);
    s.eta = rt_select(partly, one, s.eta);
    s.cos_out = rt_select(partly, p->cos_in, s.cos_out);
#endif
    return s;
}

/* The weight of the refracted ray. */
RT_INLINE rt_vec rt_refracted_weight(const rt_split *s, const rt_shade *m, rt_vec weight)
{
#ifdef RT_HAS_CUTOUTS
    /* In this order glass that is there as a whole has the same bits as in scenes without cut-outs. */
    return rt_along(s->refracted - s->tinted, weight, rt_scale(s->tinted, rt_mul(m->color, weight)));
#else
    return rt_scale(s->refracted, rt_mul(m->color, weight));
#endif
}

/* The same. *mirrored, *refracted: the lanes in which that ray has a weight above min_weight. weight: of the ray that arrived. */
RT_INLINE rt_split rt_follow(const constant rt_frame *frame, const rt_point *p, const rt_shade *m, rt_vec weight, vmask *mirrored,
                             vmask *refracted)
{
    const rt_split split = rt_fresnel(p, m);
    const vfloat least = rt_vfloat(RT_SETTING(frame, min_weight)), heaviest = rt_largest(weight);
    *mirrored = p->hits & RT_MASK(split.mirrored * heaviest > least);
    *refracted = p->hits & RT_MASK(split.refracted * heaviest > least);
    return split;
}

RT_INLINE rt_vec rt_mirror_direction(const rt_point *p)
{
    const rt_vec d = rt_along(p->cos_in * 2.0f, p->normal, p->incoming);
    /* With an interpolated normal the ray may point into the surface. Then the surface's plane mirrors it out again. */
    const vfloat below = rt_min(rt_dot(d, p->geometric), rt_vfloat(0.0f));
    return rt_normalize(rt_along(below * -2.0f, p->geometric, d));
}

RT_INLINE rt_vec rt_refracted_direction(const rt_point *p, const rt_split *s)
{
    return rt_normalize(rt_along(s->eta, p->incoming, rt_scale(s->eta * p->cos_in - s->cos_out, p->normal)));
}

#endif
