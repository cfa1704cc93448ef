/* ray_step.h -- what becomes of rays that have been traced: the light they see, and where they go on. For tracers that keep a ray
 * in registers from one surface to the next: what goes on does so in the ray's place, what parts from it is put aside. */
#ifndef RT_RAY_STEP_H
#define RT_RAY_STEP_H

/* A refracted ray that parted from a mirrored one; set where it did. */
typedef struct rt_deferred {
    rt_vec origin, direction, weight;
} rt_deferred;

/* ray, weight: in, of the rays that found `hit`; out, of those that go on, the lanes in what is returned. last: lanes in which none
 * does. light: what the rays add to their pixels, where `active`. parted: bits of the lanes in which `aside` is set. */
RT_INLINE vmask rt_step(const rt_ctx *ctx, const constant rt_frame *frame, vmask active, vmask last, rt_rays *ray, rt_hits *hit,
                        rt_vec *weight, rt_vec *light, rt_deferred *aside, uint *parted, rt_tally *tally)
{
    const uint bits = rt_bits(active);
    const rt_surface surface = rt_resolve(ctx, ray, hit, bits);
    const vmask hits = surface.hit & active;
    const uint hit_bits = rt_bits(hits);
    rt_vec seen = rt_splat(frame->background[0], frame->background[1], frame->background[2]), passed = *weight;
    vmask going = rt_vint(0);
    *parted = 0u;
    if (hit_bits != 0u) {
        const rt_point point = rt_point_of(ray, &surface, hits);
        const rt_shade material = rt_load_materials(ctx, &surface, hit_bits, point.at);
        vmask mirrored, refracted;
        const rt_split split = rt_follow(frame, &point, &material, *weight, &mirrored, &refracted);
        mirrored &= ~last;
        refracted &= ~last;
        going = mirrored | refracted;
        *parted = rt_bits(mirrored & refracted);
        rt_vec bounced = point.incoming, bent = bounced;
        if (rt_any(mirrored)) bounced = rt_mirror_direction(&point);
        if (rt_any(refracted)) bent = rt_refracted_direction(&point, &split);
        const rt_vec through = rt_scale(split.refracted, rt_mul(material.color, *weight));
        if (*parted != 0u) {
            aside->origin = rt_along(point.inward, point.geometric, point.at);
            aside->direction = bent;
            aside->weight = through;
        }
        /* The ray itself has served: the next is made in its place, before the shadow rays. */
        const vfloat side = rt_select(mirrored, point.outward, point.inward);
        const rt_vec from = rt_along(side, point.geometric, point.at), along = rt_choose(mirrored, bounced, bent);
        ray->ox = from.x, ray->oy = from.y, ray->oz = from.z;
        ray->dx = along.x, ray->dy = along.y, ray->dz = along.z;
        passed = rt_choose(mirrored, rt_scale(split.mirrored, *weight), through);
        rt_rays shadow;
        rt_vec sent;
        rt_direct_light(ctx, frame, &point, &material, 1u, &shadow, hit, &sent, tally);
        seen = rt_choose(hits, sent, seen);
    }
    *light = rt_mul(*weight, seen);
    *weight = passed;
    return going;
}

#endif
