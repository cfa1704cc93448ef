/* generations.h -- Whitted's ray tracing without recursion, as the thesis has it.
 *
 * A packet of pixels owns two arrays, the rays of the current generation and of the next. Each step traces all current rays,
 * adds what they see to their pixels and appends mirrored and refracted rays to the next array; then the arrays change places,
 * until none is left or `depth` generations are done. The arrays hold RT_RAY_SLOTS rays a pixel; a ray that finds no room is
 * dropped and counted. They are private memory for RT_MAX_PIXELS, of which only what is used is touched. */
#ifndef RT_GENERATIONS_H
#define RT_GENERATIONS_H

#ifdef RT_INSPECT
#define RT_RECORD_SPAWN(kind, bits, followed)                                                                                    \
    rt_record_spawn(&tally->recorder, next, capacity, count, kind, bits, followed, origin, direction, passed);
#else
#define RT_RECORD_SPAWN(kind, bits, followed)
#endif

/* Appends the rays that go on from the points p. */
RT_INLINE uint rt_spawn(const constant rt_frame *frame, rt_queue *next, uint capacity, uint count, const rt_point *p,
                        const rt_shade *m, rt_vec weight, vint pixel, rt_tally *tally)
{
    vmask mirrored, refracted;
    const rt_split split = rt_follow(frame, p, m, weight, &mirrored, &refracted);
    const uint mirror_bits = rt_bits(mirrored), refract_bits = rt_bits(refracted);
#ifdef RT_INSPECT
    const uint any_mirror = rt_bits(p->hits & RT_MASK(split.mirrored > rt_vfloat(0.0f))),
               any_refract = rt_bits(p->hits & RT_MASK(split.refracted > rt_vfloat(0.0f)));
#else
    const uint any_mirror = mirror_bits, any_refract = refract_bits;
#endif
    if (any_mirror != 0u) {
        const rt_vec origin = rt_along(p->offset, p->geometric, p->at), direction = rt_mirror_direction(p),
                     passed = rt_scale(split.mirrored, weight);
        RT_RECORD_SPAWN(RT_RAY_MIRROR, any_mirror, mirror_bits)
        count = rt_append(next, capacity, count, mirror_bits, origin, direction, passed, pixel, &tally->dropped);
    }
    if (any_refract != 0u) {
        const rt_vec origin = rt_along(-p->offset, p->geometric, p->at), direction = rt_refracted_direction(p, &split),
                     passed = rt_scale(split.refracted, rt_mul(m->color, weight));
        RT_RECORD_SPAWN(RT_RAY_REFRACTED, any_refract, refract_bits)
        count = rt_append(next, capacity, count, refract_bits, origin, direction, passed, pixel, &tally->dropped);
    }
    return count;
}

#ifdef RT_SHOW_GENERATIONS
/* The picture is the number of generations that each pixel has. */
RT_INLINE void rt_mark_pixels(float value, vint pixel, uint bits, float *marks)
{
    int at[RT_LANES];
    rt_store(pixel, at);
    for (uint l = 0; l < RT_LANES; ++l)
        if (bits >> l & 1u) marks[at[l]] = value;
}
#endif

/* Adds each lane's light to its pixel, one by one: two lanes may belong to the same. */
RT_INLINE void rt_add_to_pixels(rt_vec light, vint pixel, uint bits, float *red, float *green, float *blue)
{
    float r[RT_LANES], g[RT_LANES], b[RT_LANES];
    int at[RT_LANES];
    rt_store(light.x, r);
    rt_store(light.y, g);
    rt_store(light.z, b);
    rt_store(pixel, at);
    for (uint l = 0; l < RT_LANES; ++l) {
        if ((bits >> l & 1u) == 0u) continue;
        red[at[l]] += r[l];
        green[at[l]] += g[l];
        blue[at[l]] += b[l];
    }
}

/* All rays of the packet whose first pixel is `origin`. red, green, blue: sums, a number a pixel. distance: of the camera rays,
 * in the order in which they are traced; written with sample 0. */
RT_INLINE void rt_trace_generations(const rt_ctx *ctx, const constant rt_frame *frame, uint2 origin, rt_queue *queues, float *red,
                                    float *green, float *blue, global float *distance, rt_tally *tally)
{
    const uint packet_w = RT_PACKET_W(frame), pixels = packet_w * RT_PACKET_H(frame), capacity = pixels * RT_RAY_SLOTS;
    for (uint i = 0; i < pixels; ++i) red[i] = green[i] = blue[i] = 0.0f;

    uint count = RT_BLOCKS(frame) * RT_LANES; /* the first generation is made, not stored */
    for (uint generation = 0; generation < frame->depth && count != 0u; ++generation) {
        const rt_queue *current = queues + (generation & 1u);
        rt_queue *next = queues + (1u - (generation & 1u));
        uint next_count = 0;
        for (uint base = 0; base < count; base += RT_LANES) {
            rt_rays ray;
            rt_vec weight = rt_splat(1.0f, 1.0f, 1.0f);
            vint pixel;
            vmask active;
            if (generation == 0u) {
                vint in_x, in_y;
                active = rt_block_pixels(frame, origin, base / RT_LANES, &in_x, &in_y);
                pixel = in_y * rt_vint((int)packet_w) + in_x;
                rt_camera_rays(frame, in_x + rt_vint((int)origin.x), in_y + rt_vint((int)origin.y), &ray);
            } else {
                active = RT_MASK(rt_lane_index() + rt_vint((int)base) < rt_vint((int)count));
                rt_take(current, base, &ray, &weight, &pixel);
            }
            const uint bits = rt_bits(active);
            if (bits == 0u) continue;

#ifdef RT_INSPECT
            tally->recorder.generation = generation + 1u;
            if (generation == 0u)
                rt_watch_camera(&tally->recorder, &ray, pixel, bits);
            else
                rt_watch_queue(&tally->recorder, current, base, bits, weight);
#endif

            rt_hits hit;
            rt_prepare(&ray, bits);
            rt_clear_hits(&hit, active);
            rt_trace_closest(ctx, frame, &ray, &hit);
#ifdef RT_DEBUG
            tally->overflow += hit.overflow;
#endif
            /* Known for the picture's first sample, so that things can be drawn into it, before or behind what it shows. */
            if (generation == 0u && frame->sample == 0u) rt_store(hit.t, distance + base);

            const rt_surface surface = rt_resolve(ctx, &ray, &hit, bits);
            const vmask hits = surface.hit & active;
            const uint hit_bits = rt_bits(hits);
            rt_vec light = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
            if (hit_bits != 0u) {
                const rt_point point = rt_point_of(&ray, hit.t, &surface, hits);
                const rt_shade material = rt_load_materials(ctx, &surface, hit_bits, point.at);
#ifdef RT_INSPECT
                const rt_vec ambient = rt_splat(frame->ambient[0], frame->ambient[1], frame->ambient[2]),
                             none = rt_splat(0.0f, 0.0f, 0.0f);
                rt_record_hit(&tally->recorder, &hit, surface.prim, surface.material,
                              rt_choose(hits, rt_add(material.emission, rt_reflected_light(&material, ambient, none)), light));
                tally->recorder.too_deep = generation + 1u == frame->depth;
                if (tally->recorder.too_deep) rt_spawn(frame, next, 0u, 0u, &point, &material, weight, pixel, tally);
#endif
#ifndef RT_SHOW_GENERATIONS
                light = rt_choose(hits, rt_direct_light(ctx, frame, &point, &material, tally), light);
#endif
                if (generation + 1u < frame->depth)
                    next_count = rt_spawn(frame, next, capacity, next_count, &point, &material, weight, pixel, tally);
            }
#ifdef RT_INSPECT
            else
                rt_record_hit(&tally->recorder, &hit, surface.prim, surface.material, light);
#endif
#ifdef RT_SHOW_GENERATIONS
            rt_mark_pixels((float)(generation + 1u), pixel, bits, red);
#else
            rt_add_to_pixels(rt_mul(weight, light), pixel, bits, red, green, blue);
#endif
        }
        count = next_count;
        tally->secondary += next_count;
    }
}

#endif
