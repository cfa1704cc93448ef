/* inspect.h -- records the rays of one pixel while its packet is traced.
 *
 * Only the inspector's program has it (RT_INSPECT). The tracer calls these functions where rays begin, hit and add light, so
 * the records show the real rays. They work lane by lane and are slow, which does not matter for one packet. */
#ifndef RT_INSPECT_H
#define RT_INSPECT_H
#ifdef RT_INSPECT

typedef struct rt_recorder {
    global rt_ray_record *records;
    uint count, capacity; /* count may exceed capacity */
    int pixel;            /* the recorded one, within the packet */
    uint generation;      /* 1: the camera's */
    int too_deep;         /* whether the next generation is beyond the depth */
    int record[RT_LANES]; /* index for each lane's ray; -1: the ray of another pixel, or no room */
    rt_vec weight;        /* for each lane's ray */
    uint steps, leaf_tests;
} rt_recorder;

/* One lane of a vector, through memory. */
RT_INLINE float rt_lane(vfloat v, uint l)
{
    float values[RT_LANES];
    rt_store(v, values);
    return values[l];
}
RT_INLINE int rt_lane_int(vint v, uint l)
{
    int values[RT_LANES];
    rt_store(v, values);
    return values[l];
}
RT_INLINE void rt_lane_vec(rt_vec v, uint l, global float *out)
{
    out[0] = rt_lane(v.x, l);
    out[1] = rt_lane(v.y, l);
    out[2] = rt_lane(v.z, l);
}

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

/* Adds a record for the camera ray of the recorded pixel. */
RT_INLINE void rt_watch_camera(rt_recorder *rec, const rt_rays *ray, vint pixel, uint bits)
{
    rec->weight = rt_splat(1.0f, 1.0f, 1.0f);
    for (uint l = 0; l < RT_LANES; ++l) {
        rec->record[l] = -1;
        if ((bits >> l & 1u) != 0u && rt_lane_int(pixel, l) == rec->pixel)
            rec->record[l] = rt_begin_record(rec, RT_RAY_CAMERA, RT_FATE_TRACED, -1, 1u, l, rt_vec_of(ray->ox, ray->oy, ray->oz),
                                             rt_vec_of(ray->dx, ray->dy, ray->dz), rec->weight);
    }
}

/* Looks up the records of rays of a later generation. They were added when the rays were spawned. */
RT_INLINE void rt_watch_queue(rt_recorder *rec, const rt_queue *queue, uint base, uint bits, rt_vec weight)
{
    rec->weight = weight;
    for (uint l = 0; l < RT_LANES; ++l) rec->record[l] = bits >> l & 1u ? queue->record[base + l] : -1;
}

/* Records what the rays hit, and the light from there that needs no light source: emission and ambient light, or the
 * background. */
RT_INLINE void rt_record_hit(rt_recorder *rec, const rt_hits *hit, vint prim, vint material, rt_vec light)
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

/* Records the shadow rays to a light of the lanes in `bits`. lit: the lanes that the light reaches. light: the light that then
 * returns along the ray that hit the surface. asked: whether a query was made; then the recorder has its counts. */
RT_INLINE void rt_record_shadow(rt_recorder *rec, uint light_index, int asked, uint bits, uint lit, rt_vec origin, rt_vec direction,
                                vfloat distance, rt_vec light)
{
    const rt_vec added = rt_mul(rec->weight, light);
    for (uint l = 0; l < RT_LANES; ++l) {
        if (rec->record[l] < 0 || (bits >> l & 1u) == 0u) continue;
        const int index = rt_begin_record(rec, RT_RAY_SHADOW, asked ? RT_FATE_TRACED : RT_FATE_UNASKED, rec->record[l],
                                          rec->generation, l, origin, direction, rec->weight);
        if (index < 0) continue;
        global rt_ray_record *out = rec->records + index;
        out->t = rt_lane(distance, l);
        out->light_index = (int)light_index;
        out->occluded = (lit >> l & 1u) == 0u;
        if (!out->occluded) rt_lane_vec(added, l, out->light);
        out->steps = asked ? rec->steps : 0u;
        out->leaf_tests = asked ? rec->leaf_tests : 0u;
    }
}

/* Records mirrored or refracted rays, before they are appended to the queue. bits: the lanes that have such a ray. followed:
 * those with a large enough weight. They take the next elements of the queue as far as there is room. */
RT_INLINE void rt_record_spawn(rt_recorder *rec, rt_queue *next, uint capacity, uint count, uint kind, uint bits, uint followed,
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
}

#endif
#endif
