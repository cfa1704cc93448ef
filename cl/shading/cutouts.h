/* cutouts.h -- rays that go on behind surfaces that are there only in part; material.h says which share of each is.
 *
 * Traversals know nothing of it: a ray that meets a surface which is not there is traced again from behind that surface, in the same
 * direction. Only kernels of scenes with such surfaces have this code. */
#ifndef RT_CUTOUTS_H
#define RT_CUTOUTS_H
#ifdef RT_HAS_CUTOUTS

/* The share of each lane's surface that is there, and where rays that go through it start again. */
RT_CALLED vfloat rt_meet_cutout(const rt_ctx *ctx, const rt_rays *ray, const rt_hits *hit, vmask lanes, rt_vec *behind)
{
    const rt_surface surface = rt_resolve(ctx, ray, hit, rt_bits(lanes));
    const rt_point point = rt_point_of(ray, &surface, lanes);
    *behind = rt_along(point.inward, point.geometric, point.at);
    return rt_coverage(ctx, &surface, rt_bits(lanes));
}

/* Traces the rays of `lanes` from another place on, not farther than `most`. */
RT_CALLED void rt_trace_from(const rt_ctx *ctx, const constant rt_frame *frame, vmask lanes, rt_vec from, vfloat most, rt_rays *ray,
                             rt_hits *hit)
{
    ray->ox = rt_select(lanes, from.x, ray->ox);
    ray->oy = rt_select(lanes, from.y, ray->oy);
    ray->oz = rt_select(lanes, from.z, ray->oz);
    rt_prepare(ray, rt_bits(lanes));
    rt_clear_hits(hit, lanes);
    hit->t = rt_select(lanes, rt_max(most, rt_vfloat(0.0f)), hit->t);
    rt_trace_closest(ctx, frame, ray, hit);
}

/* Up to which share a surface is passed: chance decides in `path`, and only what is not there at all is passed in Whitted's tracers. */
#ifdef RT_DIMENSIONS_H
#define RT_PASSED_SHARE(sampler, event, step) rt_draw_set(sampler, RT_CUTOUT_SET(event, step)).a
#else
typedef int rt_sampler;
#define RT_PASSED_SHARE(sampler, event, step) rt_vfloat(0.0f)
#endif

/* Takes the rays of `active` past surfaces that are not there: in the end `hit` is as if those did not exist. sampler, event: of `path`. */
RT_CALLED void rt_pass_cutouts(const rt_ctx *ctx, const constant rt_frame *frame, const rt_sampler *sampler, vint event, const rt_rays *ray,
                               rt_hits *hit, vmask active, uint *dropped)
{
    rt_rays on = *ray;
    rt_hits found = *hit;
    vfloat way = rt_vfloat(0.0f);
    vmask left = active;
    for (uint step = 0;; ++step) {
        left &= RT_MASK(found.prim >= rt_vint(0));
        if (!rt_any(left)) return;
        rt_vec behind;
        left &= RT_MASK(rt_meet_cutout(ctx, &on, &found, left, &behind) <= RT_PASSED_SHARE(sampler, event, step));
        if (!rt_any(left)) return;
        if (step == RT_MOST_PASSED) {
            *dropped += popcount(rt_bits(left));
            return;
        }
        way = rt_select(left, way + found.t, way);
        rt_trace_from(ctx, frame, left, behind, RT_INFINITY, &on, &found);
        hit->t = rt_select(left, found.t + way, hit->t);
        hit->u = rt_select(left, found.u, hit->u);
        hit->v = rt_select(left, found.v, hit->v);
        hit->nx = rt_select(left, found.nx, hit->nx);
        hit->ny = rt_select(left, found.ny, hit->ny);
        hit->nz = rt_select(left, found.nz, hit->nz);
        hit->leaf = rt_select(left, found.leaf, hit->leaf);
        hit->prim = rt_select(left, found.prim, hit->prim);
        hit->instance = rt_select(left, found.instance, hit->instance);
        rt_add_counters(hit, &found);
#ifdef RT_DEBUG
        hit->overflow += found.overflow;
#endif
    }
}

/* Shadow rays of the lanes `occluded` have met a surface. Returns the share of their light that passes this surface and all others on
 * the way to the light, which is `distance` away. */
RT_CALLED vfloat rt_light_through(const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *shadow, vmask occluded, vfloat distance,
                                  uint *dropped)
{
    const vfloat zero = rt_vfloat(0.0f), one = rt_vfloat(1.0f);
    rt_rays on = *shadow;
    rt_hits found;
    rt_vec from = rt_vec_of(on.ox, on.oy, on.oz);
    vfloat way = zero, share = rt_select(occluded, one, zero);
    vmask left = occluded;
    for (uint step = 0;; ++step) {
        rt_trace_from(ctx, frame, left, from, distance - way, &on, &found);
        left &= RT_MASK(found.prim >= rt_vint(0));
        if (!rt_any(left)) return share;
        way = rt_select(left, way + found.t, way);
        share = rt_select(left, share * (one - rt_meet_cutout(ctx, &on, &found, left, &from)), share);
        left &= RT_MASK(share > zero);
        if (!rt_any(left)) return share;
        if (step == RT_MOST_PASSED) {
            *dropped += popcount(rt_bits(left));
            return rt_select(left, zero, share);
        }
    }
}

#endif
#endif
