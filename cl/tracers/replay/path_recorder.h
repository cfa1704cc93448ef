/* path_recorder.h -- records the paths of a pixel's samples while they are traced.
 *
 * Only the replay's program has it. The path tracer calls these functions where light counts and surfaces scatter (RT_RECORD), so
 * the records show the real paths. They work lane by lane. */
#ifndef RT_PATH_RECORDER_H
#define RT_PATH_RECORDER_H

/* What is known of light before rt_collect() is told of it. */
typedef struct rt_noted {
    vfloat pdf, other_pdf, mis;
    vfloat distance; /* from `from` to the light; infinite: it is beyond everything */
    rt_vec from, towards;
    vint material;
} rt_noted;

typedef struct rt_path_recorder {
    global rt_path_record *records; /* those of lane 0; each lane has `capacity` */
    uint capacity;
    uint count[RT_LANES];
    rt_noted noted;
} rt_path_recorder;

/* Adds a record of a lane, empty but for its kind and bounce. There is room for all: RT_MOST_PATH_RECORDS. */
RT_INLINE global rt_path_record *rt_add_record(rt_path_recorder *rec, uint l, uint kind, int bounce)
{
    const uint at = min(rec->count[l], rec->capacity - 1u);
    rec->count[l] = at + 1u;
    global rt_path_record *out = rec->records + (size_t)l * rec->capacity + at;
    for (uint k = 0; k < 3; ++k) out->at[k] = out->weight[k] = out->light[k] = 0.0f;
    out->kind = kind;
    out->bounce = (uint)bounce;
    out->mis = 1.0f;
    out->pdf = out->other_pdf = 0.0f;
    out->how = out->flags = out->unused = 0u;
    out->light_number = out->material = -1;
    out->first = RT_PATH_NO_EVENT;
    return out;
}

RT_INLINE void rt_record_begins(rt_path_recorder *rec, uint bits, rt_vec origin, rt_vec weight)
{
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u) continue;
        global rt_path_record *out = rt_add_record(rec, l, RT_PATH_BEGINS, 0);
        rt_lane_vec(origin, l, out->at);
        rt_lane_vec(weight, l, out->weight);
    }
}

/* Forgets what was noted. */
RT_INLINE void rt_note_nothing(rt_path_recorder *rec)
{
    rec->noted.pdf = rec->noted.other_pdf = rt_vfloat(0.0f);
    rec->noted.mis = rt_vfloat(1.0f);
    rec->noted.material = rt_vint(-1);
}
RT_INLINE void rt_note_ray(rt_path_recorder *rec, rt_vec from, rt_vec towards, vfloat distance)
{
    rec->noted.from = from;
    rec->noted.towards = towards;
    rec->noted.distance = distance;
}
RT_INLINE void rt_note_weight(rt_path_recorder *rec, vfloat pdf, vfloat other_pdf, vfloat mis)
{
    rec->noted.pdf = pdf;
    rec->noted.other_pdf = other_pdf;
    rec->noted.mis = mis;
}

/* The noted, once. */
RT_INLINE rt_noted rt_take_noted(rt_path_recorder *rec)
{
    const rt_noted noted = rec->noted;
    rt_note_nothing(rec);
    return noted;
}

/* Records light that counts. weight: the path's; light: what the sample gets. */
RT_INLINE void rt_record_light(rt_path_recorder *rec, const rt_noted *noted, vmask lanes, rt_vec weight, rt_vec light, vint bounce, uint by,
                               vint first, vint number)
{
    const uint bits = rt_bits(lanes);
    const rt_vec point = rt_along(noted->distance, noted->towards, noted->from);
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u) continue;
        if (rt_lane(light.x, l) == 0.0f && rt_lane(light.y, l) == 0.0f && rt_lane(light.z, l) == 0.0f) continue;
        global rt_path_record *out = rt_add_record(rec, l, RT_PATH_LIT, rt_lane_int(bounce, l));
        const bool beyond = rt_lane(noted->distance, l) >= 1e30f;
        rt_lane_vec(beyond ? noted->towards : point, l, out->at);
        rt_lane_vec(weight, l, out->weight);
        rt_lane_vec(light, l, out->light);
        out->pdf = rt_lane(noted->pdf, l);
        out->other_pdf = rt_lane(noted->other_pdf, l);
        out->mis = rt_lane(noted->mis, l);
        out->how = by;
        out->light_number = rt_lane_int(number, l);
        out->material = rt_lane_int(noted->material, l);
        out->first = (uint)rt_lane_int(first, l);
        out->flags = beyond ? RT_PATH_BEYOND : 0u;
    }
}

/* Records how surfaces scatter. on: the lanes that go on. weight: the throughput behind the event. kind: RT_FIRST_* of this event. */
RT_INLINE void rt_record_event(rt_path_recorder *rec, vmask lanes, vmask on, rt_vec at, vint bounce, vint kind, vmask smooth, vfloat pdf,
                               rt_vec weight, vint material)
{
    const uint bits = rt_bits(lanes), going = rt_bits(on), sharp = rt_bits(smooth);
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u) continue;
        global rt_path_record *out = rt_add_record(rec, l, RT_PATH_SCATTERS, rt_lane_int(bounce, l));
        rt_lane_vec(at, l, out->at);
        rt_lane_vec(weight, l, out->weight);
        out->pdf = (sharp >> l & 1u) != 0u ? 0.0f : rt_lane(pdf, l);
        out->how = (uint)rt_lane_int(kind, l);
        out->material = rt_lane_int(material, l);
        out->flags = ((sharp >> l & 1u) != 0u ? RT_PATH_SMOOTH : 0u) | ((going >> l & 1u) != 0u ? 0u : RT_PATH_ENDS);
    }
}

#endif
