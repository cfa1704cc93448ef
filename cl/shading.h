/* shading.h -- Whitted's model at the points that a packet hit: direct light with shadows, and where rays go on.
 * Whitted 1980, An Improved Illumination Model for Shaded Display; highlight by Blinn 1977. */
#ifndef RT_SHADING_H
#define RT_SHADING_H

#define RT_RAY_OFFSET 1.5e-5f /* 256 ulp, of the largest coordinate or the distance */

typedef struct rt_tally {
    uint shadow, secondary, dropped, overflow;
#ifdef RT_INSPECT
    rt_recorder recorder;
#endif
} rt_tally;

/* Where a ray met a surface, seen from its side. */
typedef struct rt_point {
    vmask hits;
    vmask leaving;    /* the ray comes from inside: the normals were turned */
    rt_vec at;
    rt_vec incoming;  /* unit direction of the ray */
    rt_vec geometric; /* unit normals, towards where the ray comes from */
    rt_vec normal;
    vfloat cos_in;    /* of incoming and normal, positive */
    vfloat offset;    /* how far from the surface rays start: rounding of `at` grows with its coordinates and the ray's length */
} rt_point;

RT_INLINE rt_point rt_point_of(const rt_rays *ray, vfloat distance, const rt_surface *s, vmask hits)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const vfloat t = rt_select(hits, distance, zero);
    rt_point p;
    p.hits = hits;
    p.incoming = rt_vec_of(ray->dx, ray->dy, ray->dz);
    p.at = rt_along(t, p.incoming, rt_vec_of(ray->ox, ray->oy, ray->oz));
    p.leaving = RT_MASK(rt_dot(s->geometric, p.incoming) > zero);
    const vfloat side = rt_select(p.leaving, -one, one);
    p.geometric = rt_scale(side, s->geometric);
    p.normal = rt_scale(side, s->normal);
    /* An interpolated normal may point away from the viewer at silhouettes: there the geometric one serves. */
    p.normal = rt_choose(RT_MASK(rt_dot(p.normal, p.incoming) >= zero), p.geometric, p.normal);
    p.cos_in = rt_min(-rt_dot(p.normal, p.incoming), one);
    p.offset = RT_RAY_OFFSET * rt_max(rt_largest(rt_vec_of(fabs(p.at.x), fabs(p.at.y), fabs(p.at.z))), t);
    return p;
}

/* Emission, ambient light, and every light that is not in shadow: what the points send back along the rays. */
RT_INLINE rt_vec rt_direct_light(const rt_ctx *ctx, const constant rt_frame *frame, const rt_point *p, const rt_shade *m, rt_tally *tally)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_vec above = rt_along(p->offset, p->geometric, p->at);
    rt_vec diffuse = rt_splat(frame->ambient[0], frame->ambient[1], frame->ambient[2]), shine = rt_splat(0.0f, 0.0f, 0.0f);
    for (uint i = 0; i < frame->light_count; ++i) {
        const global rt_light *light = ctx->lights + i;
        rt_vec towards = rt_spread(light->position);
        vfloat distance = RT_INFINITY;
        if (light->kind == RT_LIGHT_POINT) {
            towards = rt_sub(towards, above);
            const vfloat scale = rt_inverse_length(towards);
            distance = one / scale;
            towards = rt_scale(scale, towards);
        }
        const vfloat cosine = rt_dot(p->normal, towards);
        vmask lit = p->hits & RT_MASK(cosine > zero) & RT_MASK(rt_dot(p->geometric, towards) > zero);
        const uint lit_bits = rt_bits(lit);
        if (lit_bits == 0u) continue;
        if (frame->shadows != 0u) {
            rt_rays shadow;
            rt_hits blocked;
            shadow.ox = above.x;
            shadow.oy = above.y;
            shadow.oz = above.z;
            shadow.dx = towards.x;
            shadow.dy = towards.y;
            shadow.dz = towards.z;
            shadow.t_min = zero;
            rt_prepare(&shadow, lit_bits);
            rt_clear_hits(&blocked, lit);
            blocked.t = rt_select(lit, distance, rt_vfloat(-1.0f));
            rt_trace_any(ctx, frame, &shadow, &blocked);
            lit &= RT_MASK(blocked.t >= zero);
            tally->shadow += popcount(lit_bits);
#ifdef RT_DEBUG
            tally->overflow += blocked.overflow;
#endif
#ifdef RT_INSPECT
            tally->recorder.steps = blocked.steps;
            tally->recorder.leaf_tests = blocked.leaf_tests;
#endif
        }
        const rt_vec half_way = rt_normalize(rt_sub(towards, p->incoming));
        const vfloat highlight = rt_power(clamp(rt_dot(p->normal, half_way), zero, one), m->shininess);
        const rt_vec color = rt_spread(light->color);
        diffuse = rt_along(rt_select(lit, cosine, zero), color, diffuse);
        shine = rt_along(rt_select(lit, highlight, zero), color, shine);
#ifdef RT_INSPECT
        rt_record_shadow(&tally->recorder, i, frame->shadows != 0u, lit_bits, rt_bits(lit), above, towards, distance,
                         rt_reflected_light(m, rt_scale(cosine, color), rt_scale(highlight, color)));
#endif
    }
    return rt_add(m->emission, rt_reflected_light(m, diffuse, shine));
}

/* Shares of light that go on as mirrored and as refracted rays. */
typedef struct rt_split {
    vfloat mirrored, refracted;
    vfloat eta, cos_out; /* Snell: sin out = eta sin in */
} rt_split;

/* Fresnel's equations for unpolarised light; a refracted sine above 1 is total internal reflection. */
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
    return s;
}

/* The same, and in which lanes rays go on that weigh enough to be followed. */
RT_INLINE rt_split rt_follow(const constant rt_frame *frame, const rt_point *p, const rt_shade *m, rt_vec weight, vmask *mirrored,
                             vmask *refracted)
{
    const rt_split split = rt_fresnel(p, m);
    const vfloat least = rt_vfloat(frame->min_weight), heaviest = rt_largest(weight);
    *mirrored = p->hits & RT_MASK(split.mirrored * heaviest > least);
    *refracted = p->hits & RT_MASK(split.refracted * heaviest > least);
    return split;
}

RT_INLINE rt_vec rt_mirror_direction(const rt_point *p)
{
    const rt_vec d = rt_along(p->cos_in * 2.0f, p->normal, p->incoming);
    /* An interpolated normal may send it into the surface: then it is mirrored out again. */
    const vfloat below = rt_min(rt_dot(d, p->geometric), rt_vfloat(0.0f));
    return rt_normalize(rt_along(below * -2.0f, p->geometric, d));
}

RT_INLINE rt_vec rt_refracted_direction(const rt_point *p, const rt_split *s)
{
    return rt_normalize(rt_along(s->eta, p->incoming, rt_scale(s->eta * p->cos_in - s->cos_out, p->normal)));
}

#endif
