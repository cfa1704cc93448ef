/* emitters.h -- light for a path tracer: draws a direction towards a light, and tells of a ray what light it found and how likely
 * the same direction would have been drawn. Both speak of the same densities, so that their results can be weighted.
 *
 * Rays must test area lights after the traversal (rt_hit_lights): they are no primitives, hide nothing from shadow rays, and
 * win against a surface at the same distance. The sky and all suns are one light here: what is drawn towards any of them carries the
 * light of all of them in that direction.
 *
 * Densities are per solid angle as seen from the ray's origin, with the probability of the pick.
 *   planar      uniform by area; density distance^2 / (area cos)
 *   sphere      uniform in the cone that it fills; from within, or from its surface, uniform in all directions
 *   sun         uniform in its cone
 *   sky         uniform in all directions, or by the radiance of a gradient or a picture (sky.h) */
#ifndef RT_EMITTERS_H
#define RT_EMITTERS_H

typedef struct rt_light_sample {
    rt_vec towards;            /* unit vector */
    vfloat distance;           /* what a shadow ray must reach: a little less than the way to the light; infinite for sun and sky */
    rt_vec radiance_over_pdf;  /* times f |cos|: light that comes from there. Of delta lights: their irradiance / probability */
    vfloat pdf;                /* of the direction; of delta lights the probability of the pick */
    vmask valid;               /* the light shines to the point, if nothing is between */
    vmask delta;               /* no other ray finds this light */
    vint light;                /* number in the frame, RT_LIGHT_OF_SURFACES or RT_LIGHT_OF_SKY */
} rt_light_sample;

/* A shadow ray ends this share before an emitter, so that it does not hit the emitter itself. */
#define RT_LIGHT_CLEARANCE 1e-4f
/* What is drawn as a sphere: lights, and surfaces if primitives may be spheres. */
#define RT_LIGHTS_SPHERES (1u << RT_LIGHT_SPHERE | (RT_HAS_SPHERES ? 1u << RT_EMITTER_SURFACE : 0u))
/* Within this share of its radius^2 a point counts as on a sphere. */
#define RT_SPHERE_SHELL 1e-5f

/* The squared sine of half the angle of a sun. `radius`: the sine, which says it better than the cosine of a small angle; 0: unknown. */
RT_INLINE vfloat rt_sun_sin2(vfloat radius, vfloat cosine)
{
    return rt_select(RT_MASK(radius > rt_vfloat(0.0f)), radius * radius, (rt_vfloat(1.0f) - cosine) * (rt_vfloat(1.0f) + cosine));
}
/* 1 - cos of an angle, given its squared sine; angles up to a right one. */
RT_INLINE vfloat rt_versine(vfloat sin2) { return sin2 / (rt_vfloat(1.0f) + sqrt(rt_max(rt_vfloat(1.0f) - sin2, rt_vfloat(0.0f)))); }
RT_INLINE vfloat rt_cone_angle(vfloat versine) { return rt_vfloat(2.0f * RT_PI) * versine; }

/* A direction whose cosine to the unit vector `axis` is 1 - height at least. */
RT_INLINE rt_vec rt_in_cone(rt_vec axis, vfloat u1, vfloat u2, vfloat height)
{
    rt_vec x, y;
    rt_basis(axis, &x, &y);
    return rt_to_world(x, y, axis, rt_warp_cone(u1, u2, height));
}

/* ---- spheres. to: from the point to the middle. */

/* The density of rt_draw_sphere() where the direction meets the sphere, without the pick. */
RT_INLINE vfloat rt_sphere_density(rt_vec to, vfloat radius)
{
    const vfloat d2 = rt_dot(to, to), r2 = radius * radius;
    const vmask outside = RT_MASK(d2 > r2 * rt_vfloat(1.0f + RT_SPHERE_SHELL));
    return rt_vfloat(1.0f) / (rt_vfloat(2.0f * RT_PI) * rt_select(outside, rt_versine(rt_min(r2 / d2, rt_vfloat(1.0f))), rt_vfloat(2.0f)));
}

/* The distance at which a unit direction meets a sphere, negative if it does not. *from_within: it meets it from inside. */
RT_INLINE vfloat rt_meet_sphere(rt_vec to, vfloat radius, rt_vec direction, vmask *from_within)
{
    const vfloat zero = rt_vfloat(0.0f), none = rt_vfloat(-1.0f);
    const vfloat along = rt_dot(to, direction), c = rt_dot(to, to) - radius * radius;
    const rt_vec beside = rt_sub(to, rt_scale(along, direction));
    const vfloat room = fma(radius, radius, -rt_dot(beside, beside));
    const vfloat root = sqrt(rt_max(room, zero));
    const vmask meets = RT_MASK(room >= zero), near = RT_MASK(c > zero) & RT_MASK(along > zero);
    *from_within = ~near;
    const vfloat far_t = along + root;
    return rt_select(meets, rt_select(near, c / far_t, rt_select(RT_MASK(far_t > zero), far_t, none)), none);
}

/* Draws a direction towards a sphere. Some miss it, if the point is on its surface. Returns the density, without the pick. */
RT_INLINE vfloat rt_draw_sphere(rt_vec to, vfloat radius, vfloat u1, vfloat u2, rt_vec *direction)
{
    const vfloat d2 = rt_dot(to, to), r2 = radius * radius;
    const vmask outside = RT_MASK(d2 > r2 * rt_vfloat(1.0f + RT_SPHERE_SHELL));
    const vfloat height = rt_select(outside, rt_versine(rt_min(r2 / d2, rt_vfloat(1.0f))), rt_vfloat(2.0f));
    const rt_vec axis = rt_choose(RT_MASK(d2 > rt_vfloat(0.0f)), rt_normalize(to), rt_splat(0.0f, 0.0f, 1.0f));
    *direction = rt_in_cone(axis, u1, u2, height);
    return rt_sphere_density(to, radius);
}

/* ---- flat lights */

/* The density per solid angle of a point that is drawn uniformly from an area. cosine: of the angle at the light. */
RT_INLINE vfloat rt_flat_density(vfloat distance2, vfloat area, vfloat cosine)
{
    return distance2 / (area * cosine);
}

/* The area of an emitter that u and v span, in |u x v|. */
RT_INLINE vfloat rt_flat_factor(vint kind)
{
    return rt_select(RT_MASK(kind == rt_vint((int)RT_LIGHT_RECT)), rt_vfloat(4.0f),
                     rt_select(RT_MASK(kind == rt_vint((int)RT_LIGHT_DISC)), rt_vfloat(RT_PI), rt_vfloat(0.5f)));
}

/* The area of one side of a flat light, from its edges: `area` of rt_light may be that of both. */
RT_INLINE float rt_flat_side(const global rt_light *l)
{
    float u[3], v[3], n[3];
    for (int k = 0; k < 3; ++k) u[k] = l->u[k], v[k] = l->v[k];
    rt_cross_numbers(u, v, n);
    return l->kind == RT_LIGHT_DISC ? RT_PI * l->radius * l->radius : 4.0f * sqrt(fma(n[0], n[0], fma(n[1], n[1], n[2] * n[2])));
}

/* Whether points of its plane are on a flat light, by the vectors to them from its middle. */
RT_INLINE vmask rt_on_flat(const global rt_light *l, rt_vec within)
{
    if (l->kind == RT_LIGHT_DISC) return RT_MASK(rt_dot(within, within) <= rt_vfloat(l->radius * l->radius));
    /* Coordinates along u and v, which need not be perpendicular: by the vectors across v and across u. */
    const rt_vec n = rt_spread(l->normal), u = rt_spread(l->u), v = rt_spread(l->v), across_u = rt_cross(n, u), across_v = rt_cross(v, n);
    return RT_MASK(fabs(rt_dot(within, across_v)) <= fabs(rt_dot(u, across_v))) & RT_MASK(fabs(rt_dot(within, across_u)) <= fabs(rt_dot(v, across_u)));
}

/* Draws a point of a rect, a disc or a triangle. *to: from the point `at` to it. *density: without the pick. Returns the lanes that it
 * shines to. */
RT_INLINE vmask rt_draw_flat(const rt_lit *lit, rt_vec at, vfloat u1, vfloat u2, rt_vec *to, vfloat *density)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f), two = rt_vfloat(2.0f);
    const vmask rect = RT_MASK(lit->kind == rt_vint((int)RT_LIGHT_RECT)), disc = RT_MASK(lit->kind == rt_vint((int)RT_LIGHT_DISC));
    vfloat s, t;
    rt_warp_triangle(u1, u2, &s, &t);
    s = rt_select(rect, fma(two, u1, -one), s);
    t = rt_select(rect, fma(two, u2, -one), t);
    if (RT_MAY_SHINE(1u << RT_LIGHT_DISC) && rt_any(disc)) {
        vfloat x, y;
        rt_warp_disc(u1, u2, &x, &y);
        s = rt_select(disc, x, s);
        t = rt_select(disc, y, t);
    }
    const rt_vec n = rt_cross(lit->u, lit->v);
    const vfloat size2 = rt_dot(n, n), size = sqrt(size2);
    *to = rt_add(rt_sub(lit->p, at), rt_along(s, lit->u, rt_scale(t, lit->v)));
    const vfloat d2 = rt_dot(*to, *to), facing = -rt_dot(n, *to);
    const vfloat cosine = rt_select(lit->two_sided, fabs(facing), facing) / (size * sqrt(d2));
    const vfloat area = rt_select(RT_MASK(lit->area > zero), lit->area, rt_flat_factor(lit->kind) * size);
    const vmask shines = RT_MASK(cosine > zero) & RT_MASK(size2 > zero) & RT_MASK(d2 > zero);
    *density = rt_flat_density(d2, area, rt_select(shines, cosine, one));
    return shines;
}

/* ---- sky and suns */

/* The light from sun and sky in unit directions, and the density with which rt_light_draw() draws them. */
RT_INLINE rt_vec rt_sky(const rt_ctx *ctx, const constant rt_frame *frame, rt_vec direction, vmask lanes, vfloat *pdf)
{
    const global rt_lighting *lighting = ctx->lighting;
    const vfloat zero = rt_vfloat(0.0f);
    vfloat density = zero;
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f);
    if (RT_MAY_SHINE(1u << RT_EMITTER_SKY) && lighting->sky_emitter != RT_NONE) {
        sum = rt_sky_radiance(ctx, direction, lanes, &density);
        density *= rt_vfloat(ctx->emitters[lighting->sky_emitter].pick);
    }
    if (RT_MAY_SHINE(1u << RT_LIGHT_SUN) && lighting->sun_count != 0u)
        for (uint i = 0; i < frame->light_count; ++i) {
            const global rt_light *sun = ctx->lights + i;
            if (sun->kind != RT_LIGHT_SUN) continue;
            const vfloat sin2 = rt_sun_sin2(rt_vfloat(sun->radius), rt_vfloat(sun->cos_outer)), versine = rt_versine(sin2);
            /* Of two unit vectors the squared difference is twice 1 - cos, which does not cancel as 1 - cos does. */
            const rt_vec beside = rt_sub(direction, rt_spread(sun->position));
            const vmask inside = RT_MASK(rt_dot(beside, beside) < rt_vfloat(2.0f) * versine);
            if (!rt_any(inside)) continue;
            const vfloat inverse = rt_vfloat(1.0f) / (rt_vfloat(RT_PI) * sin2);
            sum = rt_choose(inside, rt_along(inverse, rt_spread(sun->color), sum), sum);
            density = rt_select(inside, density + rt_vfloat(ctx->emitters[i].pick) / rt_cone_angle(versine), density);
        }
    *pdf = density;
    return sum;
}

/* What camera rays see where they hit nothing. */
RT_INLINE rt_vec rt_seen_sky(const rt_ctx *ctx, const constant rt_frame *frame, rt_vec direction, vmask lanes)
{
    vfloat pdf;
    if (ctx->lighting->sky_hidden != 0u) return rt_spread(ctx->lighting->background);
    return rt_sky(ctx, frame, direction, lanes, &pdf);
}

/* ---- drawing */

#ifdef RT_HAS_MAPS
/* What the maps of drawn triangles say of the points that rt_draw_flat() draws by u1 and u2. */
RT_INLINE rt_vec rt_drawn_map(const rt_ctx *ctx, const rt_lit *lit, vfloat u1, vfloat u2, vmask lanes)
{
    rt_vec out = rt_splat(1.0f, 1.0f, 1.0f);
    vfloat s, t;
    rt_warp_triangle(u1, u2, &s, &t);
    const rt_texture_point point = rt_sharp_point(fma(s, lit->uv[2], fma(t, lit->uv[4], lit->uv[0])), fma(s, lit->uv[3], fma(t, lit->uv[5], lit->uv[1])));
    int id;
    vmask mine;
    for (rt_groups g = rt_group_lanes(lit->map, rt_bits(lanes & RT_MASK(lit->map >= rt_vint(0)))); rt_next_group(&g, &id, &mine);)
        out = rt_choose(mine, rt_sample_texture(ctx, ctx->maps[id].texture, mine, &point), out);
    return out;
}
#endif

/* Draws a light and a direction towards it from the points `at`, by three random numbers of [0, 1). */
RT_PART rt_light_sample rt_light_draw(const rt_ctx *ctx, const constant rt_frame *frame, rt_vec at, vfloat u_pick, vfloat u1, vfloat u2,
                                        vmask lanes)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_light_sample out;
    out.towards = rt_splat(0.0f, 0.0f, 1.0f);
    out.radiance_over_pdf = rt_splat(0.0f, 0.0f, 0.0f);
    out.distance = RT_INFINITY;
    out.pdf = zero;
    out.valid = out.delta = rt_vint(0);
    out.light = rt_vint(-1);
    if (ctx->lighting->emitter_count == 0u) return out;
    const rt_lit lit = rt_pick_emitters(ctx, u_pick, u1);
    lanes &= RT_MASK(lit.pick > zero);
    out.light = lit.light;
    const vfloat legacy = rt_select(lit.falloff, one, rt_vfloat(RT_PI)); /* irradiance of lights without falloff: pi times color */
#define RT_KIND(k) (RT_MAY_SHINE(1u << (k)) ? lanes & RT_MASK(lit.kind == rt_vint((int)(k))) : rt_vint(0))
#define RT_KINDS(kinds) (RT_MAY_SHINE(kinds) ? lanes & RT_MASK(((rt_vint(1) << lit.kind) & rt_vint((int)(kinds))) != rt_vint(0)) : rt_vint(0))
    const vmask point = RT_KINDS(RT_LIGHTS_POINTS), flat = RT_KINDS(RT_LIGHTS_FLAT | 1u << RT_EMITTER_SURFACE);
    const vmask sphere = RT_MAY_SHINE(RT_LIGHTS_SPHERES) ? lanes & RT_MASK(lit.kind == rt_vint((int)RT_LIGHT_SPHERE)) : rt_vint(0);
    vmask sun = RT_KIND(RT_LIGHT_SUN), directional = RT_KIND(RT_LIGHT_DIRECTIONAL);
    const vfloat sun_sin2 = rt_sun_sin2(lit.radius, lit.cos_outer);
    const vmask sharp = sun & RT_MASK(sun_sin2 <= zero);
    sun &= ~sharp;
    const vmask far = sun | RT_KIND(RT_EMITTER_SKY);
    rt_vec light = lit.color;
    vfloat density = one;
    out.delta = point | directional | sharp;
    out.valid = out.delta;
    if (RT_MAY_SHINE(RT_LIGHTS_POINTS) && rt_any(point)) {
        const rt_vec to = rt_sub(lit.p, at);
        const vfloat d2 = rt_dot(to, to), scale = rt_inverse_length(to);
        const rt_vec towards = rt_scale(scale, to);
        const vfloat share = rt_intensity_share(lit.kind, -rt_dot(lit.u, towards), lit.cos_inner, lit.cos_outer);
        const vfloat strength = share * rt_select(lit.falloff, rt_fall_off(d2, lit.radius), rt_vfloat(RT_PI));
        out.towards = rt_choose(point, towards, out.towards);
        out.distance = rt_select(point, sqrt(d2), out.distance);
        light = rt_choose(point, rt_scale(strength, lit.color), light);
        out.valid &= ~point | RT_MASK(d2 > zero) & RT_MASK(strength > zero);
    }
    if (RT_MAY_SHINE(1u << RT_LIGHT_DIRECTIONAL | 1u << RT_LIGHT_SUN) && rt_any(directional | sharp)) {
        out.towards = rt_choose(directional | sharp, lit.p, out.towards);
        light = rt_choose(directional, rt_scale(legacy, lit.color), light);
    }
    if (RT_MAY_SHINE(RT_LIGHTS_FLAT | 1u << RT_EMITTER_SURFACE) && rt_any(flat)) {
        rt_vec to;
        vfloat by_area;
        const vmask shines = flat & rt_draw_flat(&lit, at, lit.u1, u2, &to, &by_area);
        const vfloat scale = rt_inverse_length(to);
        out.towards = rt_choose(flat, rt_scale(scale, to), out.towards);
        out.distance = rt_select(flat, rt_vfloat(1.0f - RT_LIGHT_CLEARANCE) / scale, out.distance);
        density = rt_select(flat, by_area, density);
#ifdef RT_HAS_MAPS
        if (rt_any(flat & RT_MASK(lit.map >= rt_vint(0)))) light = rt_mul(light, rt_drawn_map(ctx, &lit, lit.u1, u2, flat));
#endif
        out.valid |= shines;
    }
    if (RT_MAY_SHINE(RT_LIGHTS_SPHERES) && rt_any(sphere)) {
        const rt_vec to = rt_sub(lit.p, at);
        rt_vec direction;
        vmask from_within;
        const vfloat by_cone = rt_draw_sphere(to, lit.radius, u1, u2, &direction);
        /* At the rim of the cone rounding decides whether the sphere is met. There the distance is that of the rim. */
        vfloat distance = rt_meet_sphere(to, lit.radius, direction, &from_within);
        const vfloat c = rt_dot(to, to) - lit.radius * lit.radius;
        const vmask outside = RT_MASK(c > lit.radius * lit.radius * rt_vfloat(RT_SPHERE_SHELL));
        const vmask rim = outside & (RT_MASK(distance < zero) | from_within);
        distance = rt_select(rim, sqrt(rt_max(c, zero)), distance);
        out.towards = rt_choose(sphere, direction, out.towards);
        out.distance = rt_select(sphere, distance * rt_vfloat(1.0f - RT_LIGHT_CLEARANCE), out.distance);
        density = rt_select(sphere, by_cone, density);
        out.valid |= sphere & RT_MASK(distance > zero) & (lit.two_sided | ~from_within | rim);
    }
#if RT_MAY_SCATTER(RT_LOBE_COAT)
    const vmask coated = (flat | sphere) & RT_MASK(lit.coat > zero);
    if (RT_MAY_SHINE(1u << RT_EMITTER_SURFACE) && rt_any(coated)) {
        const vfloat way = out.distance * rt_vfloat(1.0f / (1.0f - RT_LIGHT_CLEARANCE));
        const rt_vec from_middle = rt_sub(rt_along(way, out.towards, at), lit.p);
        const rt_vec normal = rt_normalize(rt_choose(sphere, from_middle, rt_cross(lit.u, lit.v)));
        light = rt_choose(coated, rt_scale(rt_through_coat(lit.coat, rt_alpha_of(lit.coat_roughness), rt_dot(normal, out.towards)), light), light);
    }
#endif
    if (RT_MAY_SHINE(RT_LIGHTS_BEYOND) && rt_any(far)) {
        rt_vec direction = rt_in_cone(lit.p, u1, u2, rt_versine(sun_sin2));
        if (rt_any(far & ~sun)) direction = rt_choose(sun, direction, rt_draw_sky(ctx, u1, u2));
        vfloat of_all;
        const rt_vec sky = rt_sky(ctx, frame, direction, far, &of_all);
        out.towards = rt_choose(far, direction, out.towards);
        light = rt_choose(far, sky, light);
        density = rt_select(far, of_all, density * lit.pick);
        out.valid |= far & RT_MASK(of_all > zero);
    } else {
        density *= lit.pick;
    }
#undef RT_KINDS
#undef RT_KIND
    out.pdf = rt_select(out.valid, density, zero);
    out.radiance_over_pdf = rt_choose(out.valid, rt_scale(one / rt_select(out.valid, density, one), light), out.radiance_over_pdf);
    return out;
}

#endif
