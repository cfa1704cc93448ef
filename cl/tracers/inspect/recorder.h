/* recorder.h -- records the rays of one pixel while its packet is traced.
 *
 * Only the inspector's program has it. The tracer calls these functions, and those of record_hits.h, where rays begin, hit and
 * add light (RT_RECORD), so the records show the real rays. They work lane by lane and are slow, which does not matter for one
 * packet. */
#ifndef RT_RECORDER_H
#define RT_RECORDER_H

typedef struct rt_recorder {
    global rt_ray_record *records;
    uint count, capacity; /* count may exceed capacity */
    int pixel;            /* the recorded one, within the packet */
    uint generation;      /* 1: the camera's */
    int too_deep;         /* whether the next generation is beyond the depth */
    int record[RT_LANES]; /* index for each lane's ray; -1: the ray of another pixel, or no room */
    rt_vec weight;        /* for each lane's ray */
} rt_recorder;

/* Adds a record with what is known when a ray begins. Returns its index, or -1 if there is no room. */
RT_INLINE int rt_begin_record(rt_recorder *rec, uint kind, uint fate, int parent, uint generation, uint lane, rt_vec origin,
                              rt_vec direction, rt_vec weight)
{
    const uint index = rec->count++;
    if (index >= rec->capacity) return -1;
    global rt_ray_record *out = rec->records + index;
    rt_lane_vec(origin, lane, out->origin);
    rt_lane_vec(direction, lane, out->direction);
    rt_lane_vec(weight, lane, out->weight);
    out->kind = kind;
    out->fate = fate;
    out->generation = generation;
    out->parent = parent;
    out->t = out->light[0] = out->light[1] = out->light[2] = 0.0f;
    out->prim = out->instance = out->material = out->light_index = -1;
    out->occluded = out->steps = out->leaf_tests = 0u;
    return (int)index;
}

/* Begins with the rays of a packet: adds a record for the camera ray of the recorded pixel, or looks up those of a later
 * generation, which were added when their rays were spawned. */
RT_INLINE void rt_record_rays(rt_recorder *rec, uint generation, const rt_queue *queue, uint base, const rt_rays *ray, vint pixel,
                              uint bits, rt_vec weight)
{
    rec->generation = generation + 1u;
    rec->weight = weight;
    for (uint l = 0; l < RT_LANES; ++l) {
        rec->record[l] = -1;
        if ((bits >> l & 1u) == 0u) continue;
        if (generation != 0u)
            rec->record[l] = queue->record[base + l];
        else if (rt_lane_int(pixel, l) == rec->pixel)
            rec->record[l] = rt_begin_record(rec, RT_RAY_CAMERA, RT_FATE_TRACED, -1, 1u, l, rt_vec_of(ray->ox, ray->oy, ray->oz),
                                             rt_vec_of(ray->dx, ray->dy, ray->dz), weight);
    }
}

/* Records the shadow rays to a light of the lanes in `bits`. lit: the lanes that the light reaches. light: the light that then
 * returns along the ray that hit the surface. asked: whether a query was made; then shadow_hit has its counts. */
RT_INLINE void rt_record_shadow(rt_recorder *rec, uint light_index, int asked, uint bits, uint lit, const rt_rays *shadow,
                                const rt_hits *shadow_hit, vfloat distance, rt_vec light)
{
    const rt_vec added = rt_mul(rec->weight, light);
    for (uint l = 0; l < RT_LANES; ++l) {
        if (rec->record[l] < 0 || (bits >> l & 1u) == 0u) continue;
        const int index = rt_begin_record(rec, RT_RAY_SHADOW, asked ? RT_FATE_TRACED : RT_FATE_UNASKED, rec->record[l],
                                          rec->generation, l, rt_vec_of(shadow->ox, shadow->oy, shadow->oz),
                                          rt_vec_of(shadow->dx, shadow->dy, shadow->dz), rec->weight);
        if (index < 0) continue;
        global rt_ray_record *out = rec->records + index;
        out->t = rt_lane(distance, l);
        out->light_index = (int)light_index;
        out->occluded = (lit >> l & 1u) == 0u;
        if (!out->occluded) rt_lane_vec(added, l, out->light);
        out->steps = asked ? shadow_hit->steps : 0u;
        out->leaf_tests = asked ? shadow_hit->leaf_tests : 0u;
    }
}

#endif
