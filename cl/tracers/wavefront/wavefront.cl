/* wavefront.cl -- traces the mirrored and the refracted ray of one surface in parallel, with a queue for the whole picture.
 *
 * Purcell, Buck, Mark, Hanrahan 2002, "Ray Tracing on Programmable Graphics Hardware"; queues as in Laine, Karras, Aila 2013,
 * "Megakernels Considered Harmful: Wavefront Path Tracing on GPUs". A ray that is both mirrored and refracted splits: the
 * mirrored ray stays with its work-item, the refracted one is deferred to the queue, for any free work-item.
 *
 * Level 0 follows camera rays, level n the rays deferred at level n - 1. A level is a launch, and the host enqueues all levels
 * at once. Only the device knows the number of rays of a level. So each launch has as many work-items as run in parallel, and
 * they claim chunks of RT_TEAM_SIZE * RT_LANES rays until none is left. Without glass there is one level, and no ray leaves its
 * registers. With glass 2^n work-items trace a pixel of 2^n rays, where iterative.cl has one work-item that holds up its warp.
 *
 * A pixel's first path, the one that level 0 follows, has a sum of its own, in the order of generations. Other paths add their
 * light as fixed-point numbers, so that the order of additions does not matter. Therefore a picture does not depend on the order
 * of work, and without splits it is bit for bit the iterative tracer's.
 *
 * A deferred ray costs 48 B written and read and 6 atomics. There are no private arrays. */

/* control: RT_CONTROL uints for each level: the number of rays, which may exceed `room`, and the tickets claimed. Zero at the
 * start. */

/* The light of deferred paths, RT_SHARE uints a pixel: for each channel 64 bits in two's complement, low half first, in units of 2^-36. */
#define RT_SHARE_UNIT 68719476736.0f
#define RT_SHARE_MOST 1e8f

RT_INLINE void rt_add_share(volatile global uint *cell, float value)
{
    const long fixed = convert_long_rte(clamp(value, -RT_SHARE_MOST, RT_SHARE_MOST) * RT_SHARE_UNIT);
    const uint low = (uint)fixed, before = atomic_add(cell, low);
    const uint high = (uint)(fixed >> 32) + (before + low < before ? 1u : 0u);
    if (high != 0u) atomic_add(cell + 1, high);
}

RT_INLINE float rt_share(const global uint *cell)
{
    return convert_float((long)((ulong)cell[0] | (ulong)cell[1] << 32)) * (1.0f / RT_SHARE_UNIT);
}

/* Traces one level. parting: whether the scene has rays that split. sums: the light of each pixel's first path, w = 1; without
 * splits, the film. shares: the light of deferred paths, used only with `parting`. counters: shadow, secondary and dropped rays
 * and full stacks of each work-group; `fresh` starts them at 0. distances: as in iterative.cl. rays: those of this level. next:
 * those of the next level, at most `room`. idle_control: the control of later pictures, none of which is being traced; it is
 * cleared. */
RT_PICTURE_KERNEL
trace_wavefront(const constant rt_frame *frame, const uint first_group, const uint group_count, const uint level, const uint fresh,
                const uint room, const uint parting, global float4 *sums, global uint *shares, global ulong4 *counters,
                global float *distances, const global float4 *rays, global float4 *next, global uint *control,
                global uint *idle_control, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    RT_TEAM_SCRATCH(scratch)
    const uint group_packets = RT_GROUP_PACKETS(frame);
    const uint count = level == 0u ? group_count * group_packets * RT_BLOCKS(frame) * RT_LANES
                                   : min(control[level * RT_CONTROL], room);
    const uint units = (count + RT_LANES - 1u) / RT_LANES, chunks = (units + RT_TEAM_SIZE - 1u) / RT_TEAM_SIZE;
    if (chunks == 0u && fresh == 0u) return;
    rt_tally tally = {0, 0, 0, 0};
    if (level == 0u)
        for (uint i = (uint)get_global_id(0); i < RT_CONTROLS; i += (uint)get_global_size(0)) idle_control[i] = 0u;
    RT_FOR_CHUNKS(chunk, chunks, control + level * RT_CONTROL + 1u, scratch)
    {
        const uint unit = chunk * RT_TEAM_SIZE + rt_team_item();
        rt_rays ray;
        rt_vec weight = rt_splat(1.0f, 1.0f, 1.0f), sum = rt_splat(0.0f, 0.0f, 0.0f);
        vint pixel = rt_vint(0), generation = rt_vint(0);
        vmask active = rt_vint(0);
        if (unit < units) {
            if (level == 0u) {
                const uint packet = unit / RT_BLOCKS(frame);
                uint group = first_group + packet / group_packets;
                const uint layer = rt_layer_of(frame, &group);
                const uint2 origin = rt_packet_origin(frame, group, packet % group_packets);
                vint x, y;
                active = rt_block_pixels(frame, origin, unit % RT_BLOCKS(frame), &x, &y);
                x += rt_vint((int)origin.x);
                y += rt_vint((int)origin.y);
                pixel = (y + rt_vint((int)(layer * frame->height))) * rt_vint((int)frame->width) + x;
                rt_camera_rays(frame + layer, x, y, &ray);
            } else {
                active = rt_load_wavefront_rays(rays, unit * RT_LANES, count, &ray, &weight, &pixel, &generation);
            }
        }
        const uint pixel_bits = rt_bits(active);

        for (uint step = 0; step < frame->depth; ++step) {
            const uint bits = rt_bits(active);
            RT_TEAM_BREAK_UNLESS(bits != 0u)
            rt_deferred deferred;
            uint splits = 0u;
            if (bits != 0u) {
                rt_hits hit;
                RT_SEEN_BY(&ray, rt_select(RT_MASK(generation == rt_vint(0)), rt_vint(RT_SEEN_BY_CAMERA), rt_vint(RT_SEEN_BY_MIRROR)))
                rt_prepare(&ray, bits);
                rt_clear_hits(&hit, active);
                rt_trace_closest(&ctx, frame, &ray, &hit);
#ifdef RT_HAS_CUTOUTS
                rt_pass_cutouts(&ctx, frame, 0, rt_vint(0), &ray, &hit, active, &tally.dropped);
#endif
                RT_TALLY_OVERFLOW(&tally, &hit)
                if (level == 0u && step == 0u && frame->sample == 0u) {
                    const uint packet = unit / RT_BLOCKS(frame);
                    uint group = first_group + packet / group_packets;
                    if (rt_layer_of(frame, &group) == 0u) {
                        const uint number = group * group_packets + packet % group_packets;
                        rt_store(hit.t, distances + ((size_t)number * RT_BLOCKS(frame) + unit % RT_BLOCKS(frame)) * RT_LANES);
                    }
                }
                const vmask last = RT_MASK(generation + 1 >= rt_vint((int)frame->depth));
                rt_vec light;
                const vmask next_lanes = rt_step(&ctx, frame, active, last, &ray, &hit, &weight, &light, &deferred, &splits, &tally);
                sum = rt_add(sum, rt_choose(active, light, rt_splat(0.0f, 0.0f, 0.0f)));
                active = next_lanes;
                generation += 1;
                tally.secondary += popcount(rt_bits(next_lanes));
            }

            uint wanted;
            const uint before = rt_team_exclusive_sum(popcount(splits), &wanted, scratch);
            const uint first = rt_team_claim(control + (level + 1u) * RT_CONTROL, wanted, scratch);
            if (rt_team_item() == 0u) {
                const uint taken = min(wanted, room - min(first, room));
                tally.secondary += taken;
                tally.dropped += wanted - taken;
            }
            if (splits != 0u)
                rt_store_wavefront_rays(next, room, first + before, splits, &ray, deferred.origin, deferred.direction, deferred.weight, pixel, generation);
        }

        if (pixel_bits != 0u) {
            float4 light[RT_LANES];
            int at[RT_LANES];
            rt_store_lanes(sum, 0.0f, light);
            rt_store(pixel, at);
            for (uint l = 0; l < RT_LANES; ++l) {
                if ((pixel_bits >> l & 1u) == 0u) continue;
                global uint *share = shares + RT_SHARE * (size_t)at[l];
                if (level == 0u) {
                    const float4 sample = (float4)(light[l].xyz, 1.0f);
                    sums[at[l]] = parting == 0u && frame->adds != 0u ? sums[at[l]] + sample : sample;
                    if (parting)
                        for (uint i = 0; i < RT_SHARE; ++i) share[i] = 0u;
                } else {
                    rt_add_share(share, light[l].x);
                    rt_add_share(share + 2, light[l].y);
                    rt_add_share(share + 4, light[l].z);
                }
            }
        }
    }

#if RT_CPU
    const uint4 all = (uint4)(tally.shadow, tally.secondary, tally.dropped, tally.overflow);
#else
    local uint group_tally[4];
    if (get_local_id(0) < 4) group_tally[get_local_id(0)] = 0u;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (tally.shadow != 0u) atomic_add(group_tally, tally.shadow);
    if (tally.secondary != 0u) atomic_add(group_tally + 1, tally.secondary);
    if (tally.dropped != 0u) atomic_add(group_tally + 2, tally.dropped);
    if (tally.overflow != 0u) atomic_add(group_tally + 3, tally.overflow);
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint4 all = (uint4)(group_tally[0], group_tally[1], group_tally[2], group_tally[3]);
#endif
    if (get_local_id(0) == 0) {
        const ulong4 before = fresh != 0u ? (ulong4)(0u) : counters[get_group_id(0)];
        counters[get_group_id(0)] = before + convert_ulong4(all);
    }
}

/* For scenes with rays that split: adds a sample to the film, or stores it if it is the first one. */
RT_PICTURE_KERNEL
add_sample(const constant rt_frame *frame, const uint first_group, global float4 *film, const global float4 *sums,
           const global uint *shares)
{
    const uint group = first_group + (uint)get_group_id(0), packet_w = RT_PACKET_W(frame), pixels = packet_w * RT_PACKET_H(frame);
    RT_FOR_PACKETS(frame, packet)
    {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        for (uint i = 0; i < pixels; ++i) {
            const uint x = origin.x + i % packet_w, y = origin.y + i / packet_w;
            if (x >= frame->width || y >= frame->height) continue;
            const uint at = y * frame->width + x;
            float4 sample = sums[at];
            const global uint *share = shares + RT_SHARE * (size_t)at;
            sample.xyz += (float3)(rt_share(share), rt_share(share + 2), rt_share(share + 4));
            film[at] = frame->adds != 0u ? film[at] + sample : sample;
        }
    }
}
