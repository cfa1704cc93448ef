/* iterative.cl -- Whitted's ray tracing without recursion, as the thesis has it.
 *
 * A packet of pixels owns two arrays, the rays of the current generation and of the next. Each step traces all current rays,
 * adds what they see to their pixels and appends mirrored and refracted rays to the next array; then the arrays change places,
 * until none is left or `depth` generations are done. The arrays hold RT_RAY_SLOTS rays a pixel; a ray that finds no room is
 * dropped and counted. They are private memory for RT_MAX_PIXELS, of which only what is used is touched. */

/* Appends the rays that go on from the points p. */
RT_INLINE uint rt_spawn(const constant rt_frame *frame, rt_queue *next, uint capacity, uint count, const rt_point *p,
                        const rt_shade *m, rt_vec weight, vint pixel, rt_tally *tally)
{
    const rt_split split = rt_fresnel(p, m);
    const vfloat least = rt_vfloat(frame->min_weight), heaviest = rt_largest(weight);
    const uint mirror_bits = rt_bits(p->hits & RT_MASK(split.mirrored * heaviest > least));
    const uint refract_bits = rt_bits(p->hits & RT_MASK(split.refracted * heaviest > least));
    if (mirror_bits != 0u)
        count = rt_append(next, capacity, count, mirror_bits, rt_along(p->offset, p->geometric, p->at), rt_mirror_direction(p),
                          rt_scale(split.mirrored, weight), pixel, &tally->dropped);
    if (refract_bits != 0u)
        count = rt_append(next, capacity, count, refract_bits, rt_along(-p->offset, p->geometric, p->at),
                          rt_refracted_direction(p, &split), rt_scale(split.refracted, rt_mul(m->color, weight)), pixel,
                          &tally->dropped);
    return count;
}

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

/* film: sums of samples, w counts them. counters: shadow, secondary, dropped rays and full stacks of each packet. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_iterative(const constant rt_frame *frame, const uint first_group, global float4 *film, global uint4 *counters, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint group = first_group + (uint)get_group_id(0);
    const uint packet_w = RT_PACKET_W(frame), pixels = packet_w * RT_PACKET_H(frame), capacity = pixels * RT_RAY_SLOTS;
    rt_queue queues[2];
    float red[RT_MAX_PIXELS], green[RT_MAX_PIXELS], blue[RT_MAX_PIXELS];
    RT_FOR_PACKETS(packet)
    {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        rt_tally tally = {0, 0, 0, 0};
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

                rt_hits hit;
                rt_prepare(&ray, bits);
                rt_clear_hits(&hit, active);
                rt_trace_closest(&ctx, frame, &ray, &hit);
#ifdef RT_DEBUG
                tally.overflow += hit.overflow;
#endif
                const rt_surface surface = rt_resolve(&ctx, &ray, &hit, bits);
                const vmask hits = surface.hit & active;
                const uint hit_bits = rt_bits(hits);
                rt_vec light = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
                if (hit_bits != 0u) {
                    const rt_point point = rt_point_of(&ray, hit.t, &surface, hits);
                    const rt_shade material = rt_load_materials(&ctx, &surface, hit_bits, point.at);
                    light = rt_choose(hits, rt_direct_light(&ctx, frame, &point, &material, &tally), light);
                    if (generation + 1u < frame->depth)
                        next_count = rt_spawn(frame, next, capacity, next_count, &point, &material, weight, pixel, &tally);
                }
                rt_add_to_pixels(rt_mul(weight, light), pixel, bits, red, green, blue);
            }
            count = next_count;
            tally.secondary += next_count;
        }

        for (uint i = 0; i < pixels; ++i) {
            const uint x = origin.x + i % packet_w, y = origin.y + i / packet_w;
            if (x >= frame->width || y >= frame->height) continue;
            const uint at = y * frame->width + x;
            const float4 sample = (float4)(red[i], green[i], blue[i], 1.0f);
            film[at] = frame->sample != 0u ? film[at] + sample : sample;
        }
        counters[group * (RT_GROUP_W * RT_GROUP_H) + packet] = (uint4)(tally.shadow, tally.secondary, tally.dropped, tally.overflow);
    }
}
