/* wavefront.cl -- generations of rays one after the other, each of the whole picture, through queues in global memory.
 * Purcell, Buck, Mark, Hanrahan 2002, Ray Tracing on Programmable Graphics Hardware; Laine, Karras, Aila 2013, Megakernels
 * Considered Harmful: Wavefront Path Tracing on GPUs.
 *
 * A ray is a work-item's own, so pixels that branch (glass) do not hold up those that do not, and lanes stay full. The host
 * enqueues all generations at once: how many rays one has is known to the device alone, so as many work-items as run side by side
 * take chunks of RT_WAVE * RT_LANES rays by ticket until none is left. Queues hold `room` rays; a ray that finds none is dropped
 * and counted.
 *
 * Where no surface refracts, a pixel has one ray at most in each generation, and its light is added at once. Else the rays that go
 * on (a claim of a chunk each, wherever there was room) are numbered anew in the order of their parents: order_claims adds the
 * claims up, join_rays writes down where the n-th ray is, and adds the light of each pixel's rays, which stand side by side
 * in that order. So a picture's sums are those of the iterative tracer's order, and do not depend on who was first.
 *
 * Costs: 48 B a ray written and read, 20 B more where order matters; no private arrays. */

/* control: for each generation RT_CONTROL uints: rays (may be beyond `room`), tickets given out. Zeroes to begin with. */
#define RT_CONTROL 2u
#define RT_CONTROLS (17u * RT_CONTROL) /* 16 generations, and one that never comes */

/* One generation. ordered: see above. sums: of this sample, a pixel each, w = 1. counters: shadow, secondary, dropped rays and full
 * stacks, of each work-group; begun anew with `fresh`. distances: as iterative.cl has them. rays, order: of this generation, the
 * first has none; next: of the coming one. lights: of each ray, in order, w = bits of the pixel's number. claims: of each chunk,
 * where its rays are in `next`, and how many. idle_control: that of the pictures after this, of whom nobody is under way. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_wavefront(const constant rt_frame *frame, const uint first_group, const uint group_count, const uint generation,
                const uint fresh, const uint room, const uint ordered, global float4 *sums, global uint4 *counters,
                global float *distances, const global float4 *rays, global float4 *next, const global uint *order,
                global float4 *lights, global uint2 *claims, global uint *control, global uint *idle_control, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    local uint scratch[RT_WAVE_SCRATCH];
    const uint group_packets = RT_GROUP_W * RT_GROUP_H, packet_w = RT_PACKET_W(frame);
    const uint count = generation == 0u ? group_count * group_packets * RT_BLOCKS(frame) * RT_LANES
                                        : min(control[generation * RT_CONTROL], room);
    const uint units = (count + RT_LANES - 1u) / RT_LANES, chunks = (units + RT_WAVE - 1u) / RT_WAVE;
    rt_tally tally = {0, 0, 0, 0};
    if (generation == 0u && get_global_id(0) == 0)
        for (uint i = 0; i < RT_CONTROLS; ++i) idle_control[i] = 0u;
    RT_FOR_CHUNKS(chunk, chunks, control + generation * RT_CONTROL + 1u, scratch)
    {
        const uint unit = chunk * RT_WAVE + rt_wave_item();
        rt_rays ray;
        rt_vec weight = rt_splat(1.0f, 1.0f, 1.0f);
        vint pixel = rt_vint(0);
        vmask active = rt_vint(0);
        if (unit < units) {
            if (generation == 0u) {
                const uint packet = unit / RT_BLOCKS(frame);
                const uint2 origin = rt_packet_origin(frame, first_group + packet / group_packets, packet % group_packets);
                vint x, y;
                active = rt_block_pixels(frame, origin, unit % RT_BLOCKS(frame), &x, &y);
                x += rt_vint((int)origin.x);
                y += rt_vint((int)origin.y);
                pixel = y * rt_vint((int)frame->width) + x;
                rt_camera_rays(frame, x, y, &ray);
            } else {
                active = rt_fetch_wave_rays(rays, ordered ? order : 0, unit * RT_LANES, count, &ray, &weight, &pixel);
            }
        }
        const uint bits = rt_bits(active);
        rt_point point;
        rt_shade material;
        rt_split split;
        uint mirror_bits = 0u, refract_bits = 0u;
        vmask hits = rt_vint(0);
        if (bits != 0u) {
            rt_hits hit;
            rt_prepare(&ray, bits);
            rt_clear_hits(&hit, active);
            rt_trace_closest(&ctx, frame, &ray, &hit);
#ifdef RT_DEBUG
            tally.overflow += hit.overflow;
#endif
            if (generation == 0u && frame->sample == 0u)
                rt_store(hit.t, distances + ((size_t)first_group * group_packets * RT_BLOCKS(frame) + unit) * RT_LANES);
            const rt_surface surface = rt_resolve(&ctx, &ray, &hit, bits);
            hits = surface.hit & active;
            const uint hit_bits = rt_bits(hits);
            if (hit_bits != 0u) {
                point = rt_point_of(&ray, hit.t, &surface, hits);
                material = rt_load_materials(&ctx, &surface, hit_bits, point.at);
                if (generation + 1u < frame->depth)
                    split = rt_follow(frame, &point, &material, weight, &mirror_bits, &refract_bits);
            }
        }

        /* Before direct light, so that less is kept over the shadow rays; and with no ray too, since all work-items must be here. */
        uint wanted;
        const uint before = rt_wave_before(popcount(mirror_bits) + popcount(refract_bits), &wanted, scratch);
        const uint first = rt_wave_claim(control + (generation + 1u) * RT_CONTROL, wanted, scratch);
        const uint taken = min(wanted, room - min(first, room));
        if (rt_wave_item() == 0u) {
            tally.secondary += taken;
            tally.dropped += wanted - taken;
            if (ordered) claims[chunk] = (uint2)(first, taken);
        }
        if (mirror_bits != 0u)
            rt_put_wave_rays(next, room, first + before, mirror_bits, refract_bits, 0u,
                             rt_along(point.offset, point.geometric, point.at), rt_mirror_direction(&point),
                             rt_scale(split.mirrored, weight), pixel);
        if (refract_bits != 0u)
            rt_put_wave_rays(next, room, first + before, refract_bits, mirror_bits, mirror_bits,
                             rt_along(-point.offset, point.geometric, point.at), rt_refracted_direction(&point, &split),
                             rt_scale(split.refracted, rt_mul(material.color, weight)), pixel);

        if (bits != 0u) {
            rt_vec light = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
            if (rt_any(hits)) light = rt_choose(hits, rt_direct_light(&ctx, frame, &point, &material, &tally), light);
            light = rt_mul(weight, light);
            float red[RT_LANES], green[RT_LANES], blue[RT_LANES];
            int at[RT_LANES];
            rt_store(light.x, red);
            rt_store(light.y, green);
            rt_store(light.z, blue);
            rt_store(pixel, at);
            for (uint l = 0; l < RT_LANES; ++l) {
                if ((bits >> l & 1u) == 0u) continue;
                const float4 sample = (float4)(red[l], green[l], blue[l], 1.0f);
                if (generation == 0u)
                    sums[at[l]] = sample;
                else if (ordered)
                    lights[unit * RT_LANES + l] = (float4)(red[l], green[l], blue[l], as_float(at[l]));
                else
                    sums[at[l]] += (float4)(red[l], green[l], blue[l], 0.0f);
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
    if (get_local_id(0) == 0) counters[get_group_id(0)] = fresh != 0u ? all : counters[get_group_id(0)] + all;
}

/* Chunks of a generation: see trace_wavefront. */
RT_INLINE uint rt_chunks(const constant rt_frame *frame, uint group_count, uint generation, uint room, const global uint *control)
{
    const uint units = generation == 0u ? group_count * (RT_GROUP_W * RT_GROUP_H) * RT_BLOCKS(frame)
                                        : (min(control[generation * RT_CONTROL], room) + RT_LANES - 1u) / RT_LANES;
    return (units + RT_WAVE - 1u) / RT_WAVE;
}

/* One work-group: how many rays each claim has becomes how many those before it have; one more entry holds them all. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
order_claims(const constant rt_frame *frame, const uint group_count, const uint generation, const uint room,
             const global uint *control, global uint2 *claims)
{
    const uint chunks = rt_chunks(frame, group_count, generation, room, control);
    const uint share = (chunks + RT_LOCAL_SIZE - 1u) / RT_LOCAL_SIZE;
    const uint begin = min((uint)get_local_id(0) * share, chunks), end = min(begin + share, chunks);
    uint before = 0u;
#if RT_LOCAL_SIZE > 1
    local uint sums[RT_LOCAL_SIZE];
    uint mine = 0u;
    for (uint i = begin; i < end; ++i) mine += claims[i].y;
    sums[get_local_id(0)] = mine;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = 0; i < get_local_id(0); ++i) before += sums[i];
#endif
    for (uint i = begin; i < end; ++i) {
        const uint taken = claims[i].y;
        claims[i].y = before;
        before += taken;
    }
    if (end == chunks && begin < end) claims[chunks] = (uint2)(0u, before);
}

/* Where each ray of the coming generation is, and this one's light into the picture. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
join_rays(const constant rt_frame *frame, const uint group_count, const uint generation, const uint room, global float4 *sums,
          const global float4 *lights, const global uint2 *claims, const global uint *control, global uint *order)
{
    const uint step = (uint)get_global_size(0);
    if (generation + 1u < frame->depth) {
        const uint chunks = rt_chunks(frame, group_count, generation, room, control);
        for (uint i = (uint)get_global_id(0) / RT_WAVE; i < chunks; i += step / RT_WAVE) {
            const uint from = claims[i].x, to = claims[i].y, taken = claims[i + 1u].y - to;
            for (uint k = rt_wave_item(); k < taken; k += RT_WAVE) order[to + k] = from + k;
        }
    }
    if (generation == 0u) return;
    /* A pixel's rays stand side by side: the work-item of the first adds them all, one after the other. */
    const uint count = min(control[generation * RT_CONTROL], room);
    for (uint i = (uint)get_global_id(0); i < count; i += step) {
        float4 light = lights[i];
        const int pixel = as_int(light.w);
        if (i > 0u && as_int(lights[i - 1u].w) == pixel) continue;
        float4 sum = sums[pixel];
        for (uint k = i;;) {
            sum.xyz += light.xyz;
            if (++k == count) break;
            light = lights[k];
            if (as_int(light.w) != pixel) break;
        }
        sums[pixel] = sum;
    }
}

/* Samples beyond the first. */
kernel void add_sample(global float4 *film, const global float4 *sums, const uint pixels)
{
    const uint i = (uint)get_global_id(0);
    if (i < pixels) film[i] += sums[i];
}
