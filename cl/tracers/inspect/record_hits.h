/* record_hits.h -- what the recorded rays hit, and which rays start there: the part of recorder.h that needs materials. It computes
 * once more what the tracer computes. */
#ifndef RT_RECORD_HITS_H
#define RT_RECORD_HITS_H

/* Records rays of one kind. bits: the lanes that have such a ray. followed: those with a large enough weight. They take the next
 * elements of the queue as far as there is room. Returns the new count. */
RT_INLINE uint rt_record_kind(rt_recorder *rec, rt_queue *next, uint capacity, uint count, uint kind, uint bits, uint followed,
                              rt_vec origin, rt_vec direction, rt_vec weight)
{
    uint at = count;
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u) continue;
        const int heavy = (followed >> l & 1u) != 0u;
        int index = -1;
        if (rec->record[l] >= 0) {
            const uint fate = !heavy           ? RT_FATE_TOO_LIGHT
                              : rec->too_deep  ? RT_FATE_TOO_DEEP
                              : at >= capacity ? RT_FATE_DROPPED
                                               : RT_FATE_TRACED;
            index = rt_begin_record(rec, kind, fate, rec->record[l], rec->generation + 1u, l, origin, direction, weight);
        }
        if (!heavy || at >= capacity) continue;
        next->record[at++] = index;
    }
    return at;
}

/* Records the mirrored and refracted rays of the points p, before rt_spawn() appends them to the queue. */
RT_INLINE void rt_record_spawned(rt_recorder *rec, const constant rt_frame *frame, rt_queue *next, uint capacity, uint count,
                                 const rt_point *p, const rt_shade *m, rt_vec weight)
{
    vmask mirrored, refracted;
    const rt_split split = rt_follow(frame, p, m, weight, &mirrored, &refracted);
    const uint any_mirror = rt_bits(p->hits & RT_MASK(split.mirrored > rt_vfloat(0.0f))),
               any_refract = rt_bits(p->hits & RT_MASK(split.refracted > rt_vfloat(0.0f)));
    count = rt_record_kind(rec, next, capacity, count, RT_RAY_MIRROR, any_mirror, rt_bits(mirrored),
                           rt_along(p->outward, p->geometric, p->at), rt_mirror_direction(p), rt_scale(split.mirrored, weight));
    rt_record_kind(rec, next, capacity, count, RT_RAY_REFRACTED, any_refract, rt_bits(refracted),
                   rt_along(p->inward, p->geometric, p->at), rt_refracted_direction(p, &split),
                   rt_refracted_weight(&split, m, weight));
}

RT_INLINE void rt_fill_records(rt_recorder *rec, const rt_hits *hit, vint prim, vint material, rt_vec light)
{
    const rt_vec added = rt_mul(rec->weight, light);
    for (uint l = 0; l < RT_LANES; ++l) {
        if (rec->record[l] < 0) continue;
        global rt_ray_record *out = rec->records + rec->record[l];
        out->prim = rt_lane_int(prim, l);
        out->t = out->prim >= 0 ? rt_lane(hit->t, l) : INFINITY;
        if (out->prim >= 0) {
            out->instance = rt_lane_int(hit->instance, l);
            out->material = rt_lane_int(material, l);
        }
        rt_lane_vec(added, l, out->light);
        out->steps = hit->steps;
        out->leaf_tests = hit->leaf_tests;
    }
}

/* Records what the rays hit, and the light from there that needs no light source: emission and ambient light, or the background.
 * Beyond the last generation it also records the rays that are not spawned. */
RT_INLINE void rt_record_hits(rt_recorder *rec, const rt_ctx *ctx, const constant rt_frame *frame, const rt_rays *ray, const rt_hits *hit,
                              vmask active, rt_queue *next, rt_vec weight)
{
    const vmask hits = active & RT_MASK(hit->prim >= rt_vint(0));
    const rt_vec behind = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
    if (!rt_any(hits)) {
        rt_fill_records(rec, hit, hit->prim, rt_vint(0), behind);
        return;
    }
    rt_surface surface = rt_resolve(ctx, ray, hit, rt_bits(active));
    RT_COMPLETE(ctx, frame, &surface, ray, hit, rt_bits(hits))
    const rt_point point = rt_point_of(ray, &surface, hits);
    const rt_shade material = rt_load_materials(ctx, &surface, rt_bits(hits), point.at);
    const rt_vec ambient = rt_splat(frame->ambient[0], frame->ambient[1], frame->ambient[2]), none = rt_splat(0.0f, 0.0f, 0.0f);
    const rt_vec light = RT_COVERED(&material, rt_add(material.emission, rt_reflected_light(&material, ambient, none)));
    rt_fill_records(rec, hit, surface.prim, surface.material, rt_choose(hits, light, behind));
    rec->too_deep = rec->generation == frame->depth;
    if (rec->too_deep) rt_record_spawned(rec, frame, next, 0u, 0u, &point, &material, weight);
}

#endif
