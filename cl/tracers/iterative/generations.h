/* generations.h -- Whitted's ray tracing without recursion, as in the thesis.
 *
 * A packet of pixels owns two arrays: the rays of the current generation and those of the next. Each step traces all current
 * rays, adds their light to their pixels and appends mirrored and refracted rays to the next array. Then the arrays are
 * swapped, until no ray is left or `depth` generations are done. An array holds RT_RAY_SLOTS rays a pixel. A ray that finds no
 * room is dropped and counted. The arrays are private memory for RT_MAX_PIXELS pixels, of which only the used part is
 * touched. */
#ifndef RT_GENERATIONS_H
#define RT_GENERATIONS_H

#ifdef RT_INSPECT
#define RT_RECORD_SPAWN(kind, bits, followed)                                                                                  \
    rt_record_spawn(&tally->recorder, next, capacity, count, kind, bits, followed, origin, direction, passed);
#else
#define RT_RECORD_SPAWN(kind, bits, followed)
#endif

#ifdef RT_SPLITS_INCOHERENT
#define RT_KEEP_AREA(bits) if (count != first) rt_store(rt_compress(p->area, bits), next->area + first);
#else
#define RT_KEEP_AREA(bits) (void)first;
#endif

/* Appends the mirrored and refracted rays of the points p. Returns the new count. */
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
        const rt_vec origin = rt_along(p->outward, p->geometric, p->at), direction = rt_mirror_direction(p),
                     passed = rt_scale(split.mirrored, weight);
        RT_RECORD_SPAWN(RT_RAY_MIRROR, any_mirror, mirror_bits)
        const uint first = count;
        count = rt_append(next, capacity, count, mirror_bits, origin, direction, passed, pixel, &tally->dropped);
        RT_KEEP_AREA(mirror_bits)
    }
    if (any_refract != 0u) {
        const rt_vec origin = rt_along(p->inward, p->geometric, p->at), direction = rt_refracted_direction(p, &split),
                     passed = rt_scale(split.refracted, rt_mul(m->color, weight));
        RT_RECORD_SPAWN(RT_RAY_REFRACTED, any_refract, refract_bits)
        const uint first = count;
        count = rt_append(next, capacity, count, refract_bits, origin, direction, passed, pixel, &tally->dropped);
        RT_KEEP_AREA(refract_bits)
    }
    return count;
}

#ifdef RT_SHOW_GENERATIONS
/* The picture shows the number of generations of each pixel. */
RT_INLINE void rt_mark_pixels(float value, vint pixel, uint bits, float4 *marks)
{
    int at[RT_LANES];
    rt_store(pixel, at);
    for (uint l = 0; l < RT_LANES; ++l)
        if (bits >> l & 1u) marks[at[l]].x = value;
}
#endif

/* Stores the light of a block of camera rays, the first of their pixels; in rows of four where a block is at least four pixels
 * wide. */
RT_INLINE void rt_begin_pixels(const constant rt_frame *frame, rt_vec light, vint pixel, uint bits, float4 *sums)
{
    float4 lanes[RT_LANES];
    int at[RT_LANES];
    rt_store_lanes(light, 1.0f, lanes);
    rt_store(pixel, at);
    if (bits == RT_ALL_LANES && frame->block_w_log2 >= 2u)
        for (uint l = 0; l < RT_LANES; l += 4u)
            for (uint x = 0; x < 4u; ++x) sums[at[l] + (int)x] = lanes[l + x];
    else
        for (uint l = 0; l < RT_LANES; ++l)
            if (bits >> l & 1u) sums[at[l]] = lanes[l];
}

/* Adds each lane's light to its pixel. One lane after the other, since two may belong to one pixel. */
RT_INLINE void rt_add_to_pixels(rt_vec light, vint pixel, uint bits, float4 *sums)
{
    float4 lanes[RT_LANES];
    int at[RT_LANES];
    rt_store_lanes(light, 0.0f, lanes);
    rt_store(pixel, at);
    if (bits == RT_ALL_LANES)
        for (uint l = 0; l < RT_LANES; ++l) sums[at[l]] += lanes[l];
    else
        for (uint l = 0; l < RT_LANES; ++l)
            if (bits >> l & 1u) sums[at[l]] += lanes[l];
}

/* Traces all rays of the packet with the first pixel `origin`. sums: each pixel's light and the weight 1, row by row. distance:
 * those of the camera rays, in the order in which they are traced; written with sample 0. */
RT_INLINE void rt_trace_generations(const rt_ctx *ctx, const constant rt_frame *frame, uint2 origin, rt_queue *queues, float4 *sums,
                                    global float *distance, rt_tally *tally)
{
    const uint packet_w = RT_PACKET_W(frame), pixels = packet_w * RT_PACKET_H(frame), capacity = pixels * RT_RAY_SLOTS;
    uint count = RT_BLOCKS(frame) * RT_LANES; /* camera rays are computed, not stored */
#ifndef RT_SHOW_GENERATIONS
    if (rt_only_background(frame, origin, sums, distance)) return;
#endif
    for (uint generation = 0; generation < frame->depth && count != 0u; ++generation) {
        const rt_queue *current = queues + (generation & 1u);
        rt_queue *next = queues + (1u - (generation & 1u));
        uint next_count = 0;
        const uint blocks = (count + RT_LANES - 1u) / RT_LANES;
        for (uint first = 0; first < blocks; first += RT_STREAM) {
            const uint stream = RT_STREAM_OF(blocks - first);
            rt_rays rays[RT_STREAM];
            rt_hits hits[RT_STREAM];
            rt_vec weights[RT_STREAM], light[RT_STREAM];
            vint pixels_of[RT_STREAM];
            vmask active[RT_STREAM];
            RT_FOR_EACH_PACKET(b, stream) {
                const uint base = (first + b) * RT_LANES;
                weights[b] = rt_splat(1.0f, 1.0f, 1.0f);
                if (generation == 0u) {
                    vint in_x, in_y;
                    active[b] = rt_block_pixels(frame, origin, first + b, &in_x, &in_y);
                    pixels_of[b] = in_y * rt_vint((int)packet_w) + in_x;
                    rt_camera_rays(frame, in_x + rt_vint((int)origin.x), in_y + rt_vint((int)origin.y), rays + b);
                } else {
                    active[b] = RT_MASK(rt_lane_index() + rt_vint((int)base) < rt_vint((int)count));
                    rt_take(current, base, rays + b, weights + b, pixels_of + b);
                }
                rt_prepare(rays + b, rt_bits(active[b]));
#ifdef RT_SPLITS_INCOHERENT
                if (generation != 0u) rays[b].incoherent = rt_incoherent(rays + b, rt_load(current->area + base), rt_bits(active[b]));
#endif
                rt_clear_hits(hits + b, active[b]);
#ifdef RT_INSPECT
                tally->recorder.generation = generation + 1u;
                if (generation == 0u)
                    rt_watch_camera(&tally->recorder, rays + b, pixels_of[b], rt_bits(active[b]));
                else
                    rt_watch_queue(&tally->recorder, current, base, rt_bits(active[b]), weights[b]);
#endif
            }
            rt_trace_stream_closest(ctx, frame, rays, hits, stream);

            rt_point points[RT_STREAM];
            rt_shade materials[RT_STREAM];
            uint any_hit = 0;
            const rt_vec behind = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
            RT_FOR_EACH_PACKET(b, stream) {
                const rt_hits *hit = hits + b;
                const uint bits = rt_bits(active[b]), hit_bits = rt_bits(active[b] & RT_MASK(hit->prim >= rt_vint(0)));
#ifdef RT_DEBUG
                tally->overflow += hit->overflow;
#endif
                /* The distances of the picture's first sample, for drawing things before or behind its surfaces. */
                if (generation == 0u && frame->sample == 0u && bits != 0u) rt_store(hit->t, distance + (first + b) * RT_LANES);

                points[b].hits = active[b] & RT_MASK(hit->prim >= rt_vint(0));
                if (hit_bits == 0u) {
#ifdef RT_INSPECT
                    rt_record_hit(&tally->recorder, hit, hit->prim, rt_vint(0), behind);
#endif
                    continue;
                }
                any_hit = 1u;
                const rt_surface surface = rt_resolve(ctx, rays + b, hit, bits);
                points[b] = rt_point_of(rays + b, &surface, points[b].hits);
                materials[b] = rt_load_materials(ctx, &surface, hit_bits, points[b].at);
#ifdef RT_INSPECT
                const rt_vec ambient = rt_splat(frame->ambient[0], frame->ambient[1], frame->ambient[2]),
                             none = rt_splat(0.0f, 0.0f, 0.0f);
                rt_record_hit(&tally->recorder, hit, surface.prim, surface.material,
                              rt_choose(points[b].hits,
                                        rt_add(materials[b].emission, rt_reflected_light(materials + b, ambient, none)), behind));
                tally->recorder.too_deep = generation + 1u == frame->depth;
                if (tally->recorder.too_deep)
                    rt_spawn(frame, next, 0u, 0u, points + b, materials + b, weights[b], pixels_of[b], tally);
#endif
            }
#if RT_STREAM > 1 && !defined(RT_SHOW_GENERATIONS)
            if (any_hit == 0u && blocks <= RT_STREAM && generation == 0u) { /* nothing but background */
                rt_fill_with_background(frame, sums);
                break;
            }
#endif
#ifndef RT_SHOW_GENERATIONS
            if (any_hit != 0u) rt_direct_light(ctx, frame, points, materials, stream, rays, hits, light, tally);
#endif
            RT_FOR_EACH_PACKET(b, stream) {
                const uint bits = rt_bits(active[b]);
                if (bits == 0u) continue;
                if (rt_any(points[b].hits) && generation + 1u < frame->depth)
                    next_count = rt_spawn(frame, next, capacity, next_count, points + b, materials + b, weights[b], pixels_of[b], tally);
#ifdef RT_SHOW_GENERATIONS
                rt_mark_pixels((float)(generation + 1u), pixels_of[b], bits, sums);
#else
                const rt_vec seen = rt_any(points[b].hits) ? rt_choose(points[b].hits, light[b], behind) : behind;
                if (generation == 0u)
                    rt_begin_pixels(frame, seen, pixels_of[b], bits, sums);
                else
                    rt_add_to_pixels(rt_mul(weights[b], seen), pixels_of[b], bits, sums);
#endif
            }
        }
        count = next_count;
        tally->secondary += next_count;
    }
}

#endif
