/* scatter.h -- one segment of each path: what its ray finds, light by next-event estimation, and the next direction.
 *
 * Kajiya 1986, The Rendering Equation; weights of two strategies by Veach, Guibas 1995, Optimally Combining Sampling Techniques
 * for Monte Carlo Rendering. */
#ifndef RT_PATH_SCATTER_H
#define RT_PATH_SCATTER_H

/* Numbers of a work-item's rays: shadow rays, rays after the camera's, rays that surfaces stop though they are cut out (RT_MOST_PASSED),
 * and full traversal stacks. */
typedef struct rt_tally {
    uint shadow, secondary, dropped, overflow;
} rt_tally;

/* Where a path meets a surface, and how the surface scatters there. */
typedef struct rt_meeting {
    rt_point point;
    rt_vec s, t;  /* with point.normal, z, the frame of the surface's directions */
    rt_vec wo;    /* towards where the path comes from, in that frame */
    rt_bsdf bsdf;
#ifdef RT_SURFACE_PLUGINS
    vint material;
#endif
} rt_meeting;

#ifdef RT_LIGHT_TREE
/* The normal by which lights are picked: surfaces that let light through are lit from both sides. */
RT_INLINE rt_vec rt_lit_normal(const rt_meeting *m)
{
    return rt_choose(rt_lets_through(&m->bsdf), rt_splat(0.0f, 0.0f, 0.0f), m->point.normal);
}
#endif

/* Paths of fewer events than this end by roulette nowhere. */
#define RT_ROULETTE_EVENT 3

#ifdef RT_HAS_MIPS
/* The angle of the cone that leaves a diffuse surface: small enough that textures lose no detail that is seen in what they light. */
#define RT_CONE_OF_ROUGH 0.05f
#endif

/* The weight of light that two strategies find. mine, other: the densities with which this one and the other one do. */
RT_INLINE vfloat rt_mis_weight(const constant rt_frame *frame, vfloat mine, vfloat other)
{
    vfloat ratio = other / mine;
    if (frame->path_flags & RT_PATH_POWER_WEIGHTS) ratio *= ratio;
    return rt_vfloat(1.0f) / (rt_vfloat(1.0f) + ratio);
}

/* The weight of light that a drawn point of a light sends. surface_pdf: with which the surface would have drawn that direction. */
RT_INLINE vfloat rt_drawn_weight(const constant rt_frame *frame, const rt_light_sample *s, vfloat surface_pdf)
{
    vfloat weight = rt_vfloat(frame->path_flags & RT_PATH_DRAWS_LIGHTS ? 1.0f : 0.0f);
    if ((frame->path_flags & RT_PATH_DRAWS_LIGHTS) && (frame->path_flags & RT_PATH_FINDS_LIGHTS))
        weight = rt_mis_weight(frame, s->pdf, surface_pdf);
    return rt_select(s->delta, rt_vfloat(1.0f), weight);
}

/* The weight of light that a path's ray finds. light_pdf: with which a light would have been drawn there; 0: it could not. */
RT_INLINE vfloat rt_found_weight(const constant rt_frame *frame, const rt_path *p, vfloat light_pdf)
{
    vfloat weight = rt_vfloat(frame->path_flags & RT_PATH_FINDS_LIGHTS ? 1.0f : 0.0f);
    if ((frame->path_flags & RT_PATH_DRAWS_LIGHTS) && (frame->path_flags & RT_PATH_FINDS_LIGHTS))
        weight = rt_mis_weight(frame, p->pdf, light_pdf);
    weight = rt_select(p->sharp | RT_MASK(light_pdf == rt_vfloat(0.0f)), rt_vfloat(1.0f), weight);
    RT_RECORD(rt_note_weight(p->recorder, rt_select(p->sharp, rt_vfloat(0.0f), p->pdf), light_pdf, weight))
    return weight;
}

/* How an event scatters, by whether its ray goes through the surface. */
RT_INLINE vint rt_kind_of_event(const rt_bsdf *bsdf, vmask sharp, vmask through)
{
    return rt_select(through, rt_vint(RT_FIRST_TRANSMISSION),
                     rt_select(sharp | ~rt_is_diffuse(bsdf), rt_vint(RT_FIRST_GLOSSY), rt_vint(RT_FIRST_DIFFUSE)));
}
/* The same of the first event of a path. */
RT_INLINE vint rt_first_kind(const rt_path *p, const rt_bsdf *bsdf, vmask sharp, vmask through)
{
    return rt_select(RT_MASK(p->event == rt_vint(0)), rt_kind_of_event(bsdf, sharp, through), p->first);
}

/* Counts light that paths have found, if it is of the kinds that are asked for. bounce: events between it and the camera. by:
 * RT_BY_*. */
RT_INLINE void rt_collect(const constant rt_frame *frame, rt_path *p, vmask lanes, rt_vec light, vint bounce, uint by, vint first, vint number)
{
    RT_RECORD(const rt_noted noted = rt_take_noted(p->recorder))
    if (RT_SETTING(frame, only_bounce) >= 0) lanes &= RT_MASK(bounce == rt_vint(RT_SETTING(frame, only_bounce)));
    if (frame->only_by != RT_NONE && frame->only_by != by) return;
    if (frame->only_first != RT_NONE) lanes &= RT_MASK(first == rt_vint((int)frame->only_first));
    if (RT_SETTING(frame, only_light) >= 0) lanes &= RT_MASK(number == rt_vint(RT_SETTING(frame, only_light)));
    light = rt_mul(p->weight, light);
#ifdef RT_SHOW_MIS
    const vfloat all = RT_LUMINANCE(light);
    light = rt_vec_of(by == RT_BY_NEE ? all : rt_vfloat(0.0f), all, rt_vfloat(0.0f));
#endif
    p->light = rt_choose(lanes, rt_add(p->light, light), p->light);
    RT_RECORD(rt_record_light(p->recorder, &noted, lanes, p->weight, light, bounce, by, first, number))
}

/* What is left of light after a way through the medium that a path is in (Beer-Lambert). */
RT_INLINE rt_vec rt_passed(const rt_path *p, vfloat distance)
{
    const vfloat way = -rt_min(distance, rt_vfloat(1e30f));
    return rt_vec_of(rt_exp(way * p->absorption.x), rt_exp(way * p->absorption.y), rt_exp(way * p->absorption.z));
}
RT_INLINE vmask rt_in_medium(const rt_path *p)
{
    return RT_MAY_SCATTER(RT_LOBE_ABSORBS) ? RT_MASK(rt_largest(p->absorption) > rt_vfloat(0.0f)) : rt_vint(0);
}

#if RT_MAY_SCATTER(RT_LOBE_GLASS)
/* Of the solids around a ray, the innermost apart from that of the surface's material: what is on the other side of its outside. */
RT_INLINE vint rt_solid_around(const rt_path *p, const rt_surface *surface)
{
    return rt_select(RT_MASK(p->inside[0] == surface->material), p->inside[1], p->inside[0]);
}

/* The ior outside of a surface: that of the solid that it lies in, 1 if it lies in none. */
RT_INLINE vfloat rt_ior_around(const rt_ctx *ctx, const rt_path *p, const rt_surface *surface, vmask lanes)
{
    const vint around = rt_solid_around(p, surface);
    vfloat ior = rt_vfloat(1.0f);
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(around, rt_bits(lanes & RT_MASK(around >= rt_vint(0)))); rt_next_group(&g, &id, &mine);)
        ior = rt_select(mine, rt_vfloat(ctx->materials[id].ior), ior);
    return ior;
}

/* Paths go through a surface: they enter its solid, or leave it and are in the one around it again. */
RT_INLINE void rt_change_medium(const rt_ctx *ctx, rt_path *p, const rt_surface *surface, vmask entering, vmask lanes)
{
    const vmask leaves = lanes & ~entering, enters = lanes & entering & ~RT_MASK(p->inside[0] == surface->material);
    vmask found = rt_vint(0); /* the place of the solid that is left, or one further in */
    for (int k = 0; k < RT_SOLIDS; ++k) {
        found |= leaves & RT_MASK(p->inside[k] == surface->material);
        p->inside[k] = rt_select(found, k + 1 < RT_SOLIDS ? p->inside[k + 1] : rt_vint(-1), p->inside[k]);
    }
    for (int k = RT_SOLIDS - 1; k > 0; --k) p->inside[k] = rt_select(enters, p->inside[k - 1], p->inside[k]);
    p->inside[0] = rt_select(enters, surface->material, p->inside[0]);
    if (!RT_MAY_SCATTER(RT_LOBE_ABSORBS)) return;
    p->absorption = rt_choose(lanes, rt_splat(0.0f, 0.0f, 0.0f), p->absorption);
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(p->inside[0], rt_bits(lanes & RT_MASK(p->inside[0] >= rt_vint(0)))); rt_next_group(&g, &id, &mine);)
        p->absorption = rt_choose(mine & lanes, rt_spread(ctx->materials[id].absorption), p->absorption);
}
#endif

/* Adds the light that arrives directly, by one shadow ray for each lane. */
RT_INLINE void rt_next_event(const rt_ctx *ctx, const constant rt_frame *frame, rt_path *p, vmask lanes, const rt_meeting *m,
                             const rt_sampler *sampler, rt_tally *tally)
{
    const rt_point *point = &m->point;
    const vfloat zero = rt_vfloat(0.0f);
    const rt_numbers n = rt_draw_set(sampler, RT_LIGHT_SET(p->event));
    const rt_vec outside = rt_along(point->outward, point->geometric, point->at);
    const rt_light_sample s = rt_light_draw(ctx, frame, outside, n.a, n.b, n.c, lanes RT_TREE_ARG(n.d) RT_TREE_ARG(rt_lit_normal(m)));
    const rt_vec wi = rt_to_local(m->s, m->t, point->normal, s.towards);
    vfloat surface_pdf;
    rt_vec light = rt_bsdf_eval(&m->bsdf, m->wo, wi, lanes, &surface_pdf);
#ifdef RT_SURFACE_PLUGINS
    rt_eval_plugins(ctx, m->material, m->bsdf.color, m->wo, wi, lanes, &light, &surface_pdf);
#endif
    light = rt_scale(rt_drawn_weight(frame, &s, surface_pdf), rt_mul(light, s.radiance_over_pdf));
    /* Shading normal and surface must agree on the side: else light would leak through, or come from behind. */
    const vmask above = RT_MASK(rt_dot(point->geometric, s.towards) > zero), agree = ~(above ^ RT_MASK(wi.z > zero));
    const vmask asked = lanes & s.valid & agree & RT_MASK(rt_largest(light) > zero);
    const uint bits = rt_bits(asked);
    if (bits == 0u) return;
    const rt_vec from = rt_along(rt_select(above, point->outward, point->inward), point->geometric, point->at);
    rt_rays ray;
    rt_hits hit;
    ray.ox = from.x, ray.oy = from.y, ray.oz = from.z;
    ray.dx = s.towards.x, ray.dy = s.towards.y, ray.dz = s.towards.z;
    ray.t_min = zero;
    RT_SEEN_BY(&ray, rt_vint(RT_SEEN_BY_SHADOW))
    rt_clear_hits(&hit, asked);
    hit.t = rt_select(asked, s.distance, rt_vfloat(-1.0f));
    if (frame->shadows != 0u) {
        rt_prepare(&ray, bits);
#ifdef RT_SPLITS_INCOHERENT
        ray.incoherent = rt_incoherent(&ray, point->area, bits);
#endif
        rt_trace_any(ctx, frame, &ray, &hit);
        tally->shadow += popcount(bits);
        RT_TALLY_OVERFLOW(tally, &hit)
    }
    vmask lit = asked & RT_MASK(hit.t >= zero);
#ifdef RT_HAS_CUTOUTS
    const vmask occluded = asked & ~lit;
    if (rt_any(occluded)) {
        const vfloat through = rt_light_through(ctx, frame, &ray, occluded, s.distance, &tally->dropped);
        light = rt_choose(occluded, rt_scale(through, light), light);
        lit |= occluded & RT_MASK(through > zero);
    }
#endif
    if (RT_MAY_SCATTER(RT_LOBE_ABSORBS) && rt_any(asked & rt_in_medium(p))) light = rt_choose(above & rt_in_medium(p), rt_mul(rt_passed(p, s.distance), light), light);
    const vint first = rt_first_kind(p, &m->bsdf, rt_vint(0), ~above);
    RT_RECORD(rt_note_ray(p->recorder, outside, s.towards, s.distance))
    RT_RECORD(rt_note_weight(p->recorder, s.pdf, rt_select(s.delta, zero, surface_pdf), rt_drawn_weight(frame, &s, surface_pdf)))
    rt_collect(frame, p, lit, light, p->event + rt_vint(1), RT_BY_NEE, first, s.light);
}

#ifdef RT_SURFACE_PLUGINS
#define RT_WITH_PLUGINS(drawn) rt_draw_plugins(ctx, m->material, m->bsdf.color, m->wo, n, lanes, drawn)
#else
#define RT_WITH_PLUGINS(drawn) drawn
#endif
/* Draws the next directions. Returns the lanes that go on. */
RT_INLINE vmask rt_next_direction(const rt_ctx *ctx, rt_path *p, vmask lanes, const rt_surface *surface, const rt_meeting *m,
                                  const rt_sampler *sampler)
{
    const rt_point *point = &m->point;
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    const rt_numbers n = rt_draw_set(sampler, RT_SURFACE_SET(p->event));
    const rt_bsdf_sample s = RT_WITH_PLUGINS(rt_bsdf_draw(&m->bsdf, m->wo, n.a, n.b, n.c, lanes));
    const rt_vec direction = rt_normalize(rt_to_world(m->s, m->t, point->normal, s.wi));
    const vmask above = RT_MASK(rt_dot(point->geometric, direction) > zero), agree = above ^ s.transmitted;
    rt_vec weight = rt_mul(p->weight, s.weight);
    vmask on = lanes & s.valid & agree & RT_MASK(rt_largest(weight) > zero);
    /* Roulette: a path of small weight ends by chance, and those that go on stand for it. What radiance loses by entering glass
     * it gains again by leaving. */
    const vfloat scale = rt_select(s.transmitted, p->scale * m->bsdf.eta * m->bsdf.eta, p->scale);
    const vfloat chance = rt_select(RT_MASK(p->event + rt_vint(1) < rt_vint(RT_ROULETTE_EVENT)), one, rt_max(rt_min(scale * rt_largest(weight), one), rt_vfloat(0.05f)));
    on &= RT_MASK(n.d < chance);
    weight = rt_scale(one / chance, weight);

    const rt_vec from = rt_along(rt_select(above, point->outward, point->inward), point->geometric, point->at);
    p->origin = rt_choose(on, from, p->origin);
    p->direction = rt_choose(on, direction, p->direction);
    p->weight = rt_choose(on, weight, p->weight);
    p->pdf = rt_select(on, s.pdf, p->pdf);
    RT_BY_TREE(p->normal = rt_choose(on, rt_lit_normal(m), p->normal);)
    p->sharp = rt_select(on, s.delta, p->sharp);
    p->scale = rt_select(on, scale, p->scale);
#ifdef RT_HAS_MIPS
    /* What a rough surface sends is seen as through a cone of its own: the wider, the less likely the direction. */
    const vfloat widened = rt_max(p->cone_angle, rt_vfloat(RT_CONE_OF_ROUGH) / sqrt(rt_max(s.pdf, one)));
    p->cone_angle = rt_select(on & ~s.delta, widened, p->cone_angle);
#endif
#if RT_MAY_SCATTER(RT_LOBE_GLASS)
    if (rt_any(on & s.transmitted & ~rt_is_sheet(&m->bsdf))) rt_change_medium(ctx, p, surface, ~point->leaving, on & s.transmitted & ~rt_is_sheet(&m->bsdf));
#endif
    p->first = rt_first_kind(p, &m->bsdf, s.delta, s.transmitted);
    RT_RECORD(rt_record_event(p->recorder, lanes, on, point->at, p->event + rt_vint(1), rt_kind_of_event(&m->bsdf, s.delta, s.transmitted), s.delta,
                              s.pdf, weight, surface->material))
    p->event += rt_vint(1);
#ifdef RT_SPLITS_INCOHERENT
    p->area = rt_select(on, point->area, p->area);
#endif
    return on;
}

/* Traces the rays of the paths that are alive. Returns the lanes whose paths go on. distances: of the packet's camera rays. */
RT_INLINE vmask rt_trace_segment(const rt_ctx *ctx, const constant rt_frame *frame, rt_path *p, global float *distances, rt_tally *tally)
{
    const uint bits = rt_bits(p->alive);
    rt_rays ray;
    rt_hits hit;
    ray.ox = p->origin.x, ray.oy = p->origin.y, ray.oz = p->origin.z;
    ray.dx = p->direction.x, ray.dy = p->direction.y, ray.dz = p->direction.z;
    ray.t_min = rt_vfloat(0.0f);
    RT_SEEN_BY(&ray, rt_select(RT_MASK(p->event == rt_vint(0)), rt_vint(RT_SEEN_BY_CAMERA), rt_vint(RT_SEEN_BY_MIRROR)))
    rt_prepare(&ray, bits);
#ifdef RT_SPLITS_INCOHERENT
    ray.incoherent = rt_incoherent(&ray, p->area, bits);
#endif
    rt_clear_hits(&hit, p->alive);
    rt_trace_closest(ctx, frame, &ray, &hit);
#ifdef RT_HAS_CUTOUTS
    const rt_sampler chances = rt_sampler_of(frame, p);
    rt_pass_cutouts(ctx, frame, &chances, p->event, &ray, &hit, p->alive, &tally->dropped);
#endif
    RT_TALLY_OVERFLOW(tally, &hit)
    if (frame->sample == 0u) {
        const uint first = bits & rt_bits(RT_MASK(p->event == rt_vint(0)) & RT_MASK(p->sample == rt_vint(0)));
        if (first != 0u) RT_FOR_LANES_STORE(distances, p->slot, hit.t, first)
    }

    vfloat t = hit.t;
    vint light;
    rt_hit_lights(ctx, frame, &ray, &t, &light);
    RT_RECORD(rt_note_ray(p->recorder, p->origin, p->direction, t))
    if (RT_MAY_SCATTER(RT_LOBE_ABSORBS) && rt_any(p->alive & rt_in_medium(p))) p->weight = rt_choose(rt_in_medium(p), rt_mul(rt_passed(p, t), p->weight), p->weight);
    const vmask lights = p->alive & RT_MASK(light >= rt_vint(0)), hits = p->alive & ~lights & RT_MASK(hit.prim >= rt_vint(0));
    const vmask missed = p->alive & ~lights & ~hits;
    vfloat pdf;
    if (RT_MAY_SHINE(RT_LIGHTS_SOLID) && rt_any(lights)) {
        const rt_vec found = rt_emission_of_light(ctx, &ray, t, light, lights RT_TREE_ARG(p->normal), &pdf);
        rt_collect(frame, p, lights, rt_scale(rt_found_weight(frame, p, pdf), found), p->event, RT_BY_BSDF, p->first, light);
    }
    if (RT_MAY_SHINE(RT_LIGHTS_BEYOND) && rt_any(missed)) {
        const vmask seen = missed & RT_MASK(p->event == rt_vint(0));
        rt_vec found = rt_scale(rt_vfloat(0.0f), p->direction);
        if (rt_any(missed & ~seen)) {
            found = rt_sky(ctx, frame, p->direction, missed, &pdf);
            found = rt_scale(rt_found_weight(frame, p, pdf), found);
        }
        if (rt_any(seen)) found = rt_choose(seen, rt_seen_sky(ctx, frame, p->direction, seen), found);
        rt_collect(frame, p, missed, found, p->event, RT_BY_BSDF, p->first, rt_vint(RT_LIGHT_OF_SKY));
    }
    const uint hit_bits = rt_bits(hits);
    RT_GUIDE(rt_guide_end(frame, p, p->alive & ~hits))
    if (hit_bits == 0u) return hits;
    rt_surface surface = rt_resolve(ctx, &ray, &hit, bits);
#ifdef RT_HAS_MIPS
    p->cone = fma(rt_select(hits, hit.t, rt_vfloat(0.0f)), p->cone_angle, p->cone);
#endif
    RT_SPREAD_SURFACE(frame, &surface, &ray, p->cone)
    RT_MAP_NORMALS(ctx, &surface, hit_bits)
    rt_meeting m;
    m.point = rt_point_of(&ray, &surface, hits);
    if (RT_MAY_SHINE(1u << RT_EMITTER_SURFACE)) {
        const rt_vec found = rt_emission_of_hit(ctx, &ray, &hit, &surface, hits RT_TREE_ARG(p->normal), &pdf);
        RT_RECORD(p->recorder->noted.material = surface.material)
        rt_collect(frame, p, hits, rt_scale(rt_found_weight(frame, p, pdf), found), p->event, RT_BY_BSDF, p->first, rt_vint(RT_LIGHT_OF_SURFACES));
    }

    vmask scattered = hits & RT_MASK(p->event < rt_vint((int)frame->depth));
#if RT_MAY_SCATTER(RT_LOBE_UNLIT)
    /* Surfaces that are not lit end paths: with their colour where a camera sees them, directly or by what is smooth. */
    rt_vec shown;
    const vmask unlit = rt_unlit(ctx, &surface, hit_bits, m.point.at, &shown);
    RT_RECORD(p->recorder->noted.material = surface.material)
    if (rt_any(unlit)) rt_collect(frame, p, unlit & p->sharp, shown, p->event, RT_BY_BSDF, p->first, rt_vint(RT_LIGHT_OF_SURFACES));
    scattered &= ~unlit;
#endif
    const uint scattered_bits = rt_bits(scattered);
    RT_GUIDE(rt_guide_end(frame, p, hits & ~scattered))
    if (scattered_bits == 0u) return scattered;
    const rt_sampler sampler = rt_sampler_of(frame, p);
    rt_basis(m.point.normal, &m.s, &m.t);
#ifdef RT_HAS_TANGENTS
    rt_turn_frame(&surface, m.point.normal, &m.s, &m.t);
#endif
    m.wo = rt_to_local(m.s, m.t, m.point.normal, rt_scale(rt_vfloat(-1.0f), m.point.incoming));
    vfloat around = rt_vfloat(1.0f);
#if RT_MAY_SCATTER(RT_LOBE_GLASS)
    around = rt_ior_around(ctx, p, &surface, scattered);
#endif
    m.bsdf = rt_bsdf_of(ctx, &surface, ~m.point.leaving, around, scattered_bits, m.point.at);
#ifdef RT_SURFACE_PLUGINS
    m.material = surface.material;
#endif
    RT_GUIDE(rt_guide_surface(frame, p, scattered, t, m.point.normal, &m.bsdf))
    if (ctx->lighting->emitter_count != 0u) rt_next_event(ctx, frame, p, scattered, &m, &sampler, tally);
    const vmask on = rt_next_direction(ctx, p, scattered, &surface, &m, &sampler);
    tally->secondary += popcount(rt_bits(on));
    return on;
}

#endif
