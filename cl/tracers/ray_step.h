/* ray_step.h -- shades a hit and makes the next rays, for tracers that keep a ray in registers from one surface to the next.
 *
 * The next ray replaces the one that was traced. Where a ray is both mirrored and refracted, the refracted ray is deferred. */
#ifndef RT_RAY_STEP_H
#define RT_RAY_STEP_H

/* The refracted rays of lanes that are mirrored too. Undefined in other lanes. */
typedef struct rt_deferred {
    rt_vec origin, direction, weight;
} rt_deferred;

/* ray, weight: in, those that found `hit`; out, those of the next rays, in the lanes that are returned. last: lanes that make
 * no next rays. light: the light that the `active` lanes add to their pixels. splits: the bits of the lanes in which `deferred`
 * is set. */
RT_INLINE vmask rt_step(const rt_ctx *ctx, const constant rt_frame *frame, vmask active, vmask last, rt_rays *ray, rt_hits *hit,
                        rt_vec *weight, rt_vec *light, rt_deferred *deferred, uint *splits, rt_tally *tally)
{
    const uint bits = rt_bits(active);
    rt_surface surface = rt_resolve(ctx, ray, hit, bits);
    const vmask hits = surface.hit & active;
    const uint hit_bits = rt_bits(hits);
    rt_vec seen = rt_splat(frame->background[0], frame->background[1], frame->background[2]), passed = *weight;
    vmask next_lanes = rt_vint(0);
    *splits = 0u;
    if (hit_bits != 0u) {
        RT_COMPLETE(ctx, frame, &surface, ray, hit, hit_bits)
        const rt_point point = rt_point_of(ray, &surface, hits);
        const rt_shade material = rt_load_materials(ctx, &surface, hit_bits, point.at);
        vmask mirrored, refracted;
        const rt_split split = rt_follow(frame, &point, &material, *weight, &mirrored, &refracted);
        mirrored &= ~last;
        refracted &= ~last;
        next_lanes = mirrored | refracted;
        *splits = rt_bits(mirrored & refracted);
        rt_vec bounced = point.incoming, bent = bounced;
        if (rt_any(mirrored)) bounced = rt_mirror_direction(&point);
        if (rt_any(refracted)) bent = rt_refracted_direction(&point, &split);
        const rt_vec through = rt_refracted_weight(&split, &material, *weight);
        if (*splits != 0u) {
            deferred->origin = rt_along(point.inward, point.geometric, point.at);
            deferred->direction = bent;
            deferred->weight = through;
        }
        /* The traced ray is no longer needed. The next one replaces it, before shadow rays take registers. */
        const vfloat side = rt_select(mirrored, point.outward, point.inward);
        const rt_vec from = rt_along(side, point.geometric, point.at), along = rt_choose(mirrored, bounced, bent);
        ray->ox = from.x, ray->oy = from.y, ray->oz = from.z;
        ray->dx = along.x, ray->dy = along.y, ray->dz = along.z;
#ifdef RT_CARRIES_CONES
        ray->travelled = point.travelled;
#endif
        passed = rt_choose(mirrored, rt_scale(split.mirrored, *weight), through);
        rt_rays shadow;
        rt_vec sent;
        rt_direct_light(ctx, frame, &point, &material, 1u, &shadow, hit, &sent, tally);
        seen = rt_choose(hits, sent, seen);
    }
    *light = rt_mul(*weight, seen);
    *weight = passed;
    return next_lanes;
}

#endif
