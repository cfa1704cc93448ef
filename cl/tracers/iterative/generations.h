/* generations.h -- Whitted's ray tracing without recursion, as in the thesis.
 *
 * A packet of pixels owns two arrays: the rays of the current generation and those of the next. Each step traces all current
 * rays, adds their light to their pixels and appends mirrored and refracted rays to the next array. Then the arrays are
 * swapped, until no ray is left or `depth` generations are done. An array holds RT_RAY_SLOTS rays a pixel. A ray that finds no
 * room is dropped and counted. The arrays are private memory for RT_MAX_PIXELS pixels, of which only the used part is
 * touched. */
#ifndef RT_GENERATIONS_H
#define RT_GENERATIONS_H

/* Appends the mirrored and refracted rays of the points p. Returns the new count. */
RT_INLINE uint rt_spawn(const constant rt_frame *frame, rt_queue *next, uint capacity, uint count, const rt_point *p,
                        const rt_shade *m, rt_vec weight, vint pixel, rt_tally *tally)
{
    RT_RECORD(rt_record_spawned(&tally->recorder, frame, next, capacity, count, p, m, weight))
    vmask mirrored, refracted;
    const rt_split split = rt_follow(frame, p, m, weight, &mirrored, &refracted);
    const uint mirror_bits = rt_bits(mirrored), refract_bits = rt_bits(refracted);
    if (mirror_bits != 0u) {
        const uint first = count;
        count = rt_append(next, capacity, count, mirror_bits, rt_along(p->outward, p->geometric, p->at), rt_mirror_direction(p),
                          rt_scale(split.mirrored, weight), pixel, &tally->dropped);
        RT_KEEP_AREA(next, first, count, p, mirror_bits)
        RT_KEEP_CONE(next, first, count, p->travelled, mirror_bits)
    }
    if (refract_bits != 0u) {
        const uint first = count;
        count = rt_append(next, capacity, count, refract_bits, rt_along(p->inward, p->geometric, p->at), rt_refracted_direction(p, &split),
                          rt_refracted_weight(&split, m, weight), pixel, &tally->dropped);
        RT_KEEP_AREA(next, first, count, p, refract_bits)
        RT_KEEP_CONE(next, first, count, p->travelled, refract_bits)
    }
    return count;
}

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

#ifdef RT_SHOW_GENERATIONS
/* The picture shows the number of generations of each pixel: light counts for nothing. */
#define RT_SHOWS_LIGHT 0
RT_INLINE void rt_see(const constant rt_frame *frame, uint generation, rt_vec seen, rt_vec weight, vint pixel, uint bits, float4 *sums)
{
    int at[RT_LANES];
    rt_store(pixel, at);
    for (uint l = 0; l < RT_LANES; ++l)
        if (bits >> l & 1u) sums[at[l]].x = (float)(generation + 1u);
}
#else
#define RT_SHOWS_LIGHT 1
/* Adds what the rays of a generation see to their pixels. */
RT_INLINE void rt_see(const constant rt_frame *frame, uint generation, rt_vec seen, rt_vec weight, vint pixel, uint bits, float4 *sums)
{
    if (generation == 0u)
        rt_begin_pixels(frame, seen, pixel, bits, sums);
    else
        rt_add_to_pixels(rt_mul(weight, seen), pixel, bits, sums);
}
#endif

/* Traces all rays of the packet with the first pixel `origin`. sums: each pixel's light and the weight 1, row by row. distance:
 * those of the camera rays, in the order in which they are traced; written with sample 0. */
RT_INLINE void rt_trace_generations(const rt_ctx *ctx, const constant rt_frame *frame, uint2 origin, rt_queue *queues, float4 *sums,
                                    global float *distance, rt_tally *tally)
{
    const uint packet_w = RT_PACKET_W(frame), pixels = packet_w * RT_PACKET_H(frame), capacity = pixels * RT_RAY_SLOTS;
    uint count = RT_BLOCKS(frame) * RT_LANES; /* camera rays are computed, not stored */
    if (RT_SHOWS_LIGHT && rt_only_background(frame, origin, sums, distance)) return;
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
                RT_SEEN_BY(rays + b, rt_vint(generation == 0u ? RT_SEEN_BY_CAMERA : RT_SEEN_BY_MIRROR))
                rt_prepare(rays + b, rt_bits(active[b]));
                RT_USE_AREA(generation, current, base, rays + b, active[b])
                rt_clear_hits(hits + b, active[b]);
                RT_RECORD(rt_record_rays(&tally->recorder, generation, current, base, rays + b, pixels_of[b], rt_bits(active[b]), weights[b]))
            }
            rt_trace_stream_closest(ctx, frame, rays, hits, stream);
#ifdef RT_HAS_CUTOUTS
            RT_FOR_EACH_PACKET(b, stream)
                rt_pass_cutouts(ctx, frame, 0, rt_vint(0), rays + b, hits + b, active[b], &tally->dropped);
#endif

            rt_point points[RT_STREAM];
            rt_shade materials[RT_STREAM];
            uint any_hit = 0;
            const rt_vec behind = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
            RT_FOR_EACH_PACKET(b, stream) {
                const rt_hits *hit = hits + b;
                const uint bits = rt_bits(active[b]), hit_bits = rt_bits(active[b] & RT_MASK(hit->prim >= rt_vint(0)));
                RT_TALLY_OVERFLOW(tally, hit)
                RT_RECORD(rt_record_hits(&tally->recorder, ctx, frame, rays + b, hit, active[b], next, weights[b]))
                /* The distances of the picture's first sample, for drawing things before or behind its surfaces. */
                if (generation == 0u && frame->sample == 0u && bits != 0u) rt_store(hit->t, distance + (first + b) * RT_LANES);

                points[b].hits = active[b] & RT_MASK(hit->prim >= rt_vint(0));
                if (hit_bits == 0u) continue;
                any_hit = 1u;
                rt_surface surface = rt_resolve(ctx, rays + b, hit, bits);
                RT_COMPLETE(ctx, frame, &surface, rays + b, hit, hit_bits)
                points[b] = rt_point_of(rays + b, &surface, points[b].hits);
                materials[b] = rt_load_materials(ctx, &surface, hit_bits, points[b].at);
            }
            if (RT_STREAM > 1 && RT_SHOWS_LIGHT && any_hit == 0u && blocks <= RT_STREAM && generation == 0u) { /* nothing but background */
                rt_fill_with_background(frame, sums);
                break;
            }
            if (RT_SHOWS_LIGHT && any_hit != 0u) rt_direct_light(ctx, frame, points, materials, stream, rays, hits, light, tally);
            RT_FOR_EACH_PACKET(b, stream) {
                const uint bits = rt_bits(active[b]);
                if (bits == 0u) continue;
                if (rt_any(points[b].hits) && generation + 1u < frame->depth)
                    next_count = rt_spawn(frame, next, capacity, next_count, points + b, materials + b, weights[b], pixels_of[b], tally);
                const rt_vec seen = rt_any(points[b].hits) ? rt_choose(points[b].hits, light[b], behind) : behind;
                rt_see(frame, generation, seen, weights[b], pixels_of[b], bits, sums);
            }
        }
        count = next_count;
        tally->secondary += next_count;
    }
}

#endif
