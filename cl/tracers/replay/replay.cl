/* replay.cl -- traces the samples of one pixel once more and records their paths; and adds the samples as the film does.
 *
 * A lane has one sample: see path.cl, where lanes have pixels. Samples are the same whatever is traced beside them, so their light
 * has the bits that it has in a picture. */

/* Samples [frame->sample, frame->sample + frame->samples) of the film's pixel (x, y). records: `capacity` of each sample, of which
 * `counts` says how many there are. lights: of each sample. distances: room for a packet's. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
replay_samples(const constant rt_frame *frame, const uint x, const uint y, global rt_path_record *records, const uint capacity,
               global uint *counts, global float4 *lights, global float *distances, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint first = (uint)get_global_id(0) * RT_LANES;
    if (first >= frame->samples) return;
    rt_tally tally = {0, 0, 0, 0};
    rt_path_recorder recorder;
    recorder.records = records + (size_t)first * capacity;
    recorder.capacity = capacity;
    for (uint l = 0; l < RT_LANES; ++l) recorder.count[l] = 0u;
    rt_note_nothing(&recorder);

    rt_path paths = rt_no_paths(frame);
    paths.recorder = &recorder;
    /* Each lane is as if it had just ended the sample before its own, and no other pixel follows. */
    paths.sample = rt_vint((int)(frame->sample + first) - 1) + rt_lane_index();
    uint next = RT_BLOCKS(frame) * RT_LANES;
    rt_refill(frame, 0, (uint2)(x, y), &paths, &next);
    const uint begun = rt_bits(paths.alive);
    rt_record_begins(&recorder, begun, paths.origin, paths.weight);
    while (rt_any(paths.alive)) paths.alive = rt_trace_segment(&ctx, frame, &paths, distances, &tally);

    float4 light[RT_LANES];
    rt_store_lanes(paths.light, 1.0f, light);
    for (uint l = 0; l < RT_LANES; ++l)
        if (begun >> l & 1u) {
            lights[first + l] = light[l];
            counts[first + l] = recorder.count[l];
        }
}

/* The random numbers of the first samples of pixel (x, y) of the film: of each sample `sets` sets of four, from the camera's on. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
draw_numbers(const constant rt_frame *frame, const uint x, const uint y, const uint sets, global float4 *numbers)
{
    const uint first = (uint)get_global_id(0) * RT_LANES;
    if (first >= frame->samples) return;
    rt_path path = rt_no_paths(frame);
    path.sample = rt_vint((int)first) + rt_lane_index();
    path.pixel = rt_vint((int)((y + frame->first_y) * frame->whole_width + x + frame->first_x));
    const rt_sampler sampler = rt_sampler_of(frame, &path);
    for (uint set = 0; set < sets; ++set) {
        const rt_numbers n = rt_draw_set(&sampler, rt_vint((int)set));
        float a[RT_LANES], b[RT_LANES], c[RT_LANES], d[RT_LANES];
        rt_store(n.a, a), rt_store(n.b, b), rt_store(n.c, c), rt_store(n.d, d);
        for (uint l = 0; l < RT_LANES && first + l < frame->samples; ++l)
            numbers[(size_t)(first + l) * sets + set] = (float4)(a[l], b[l], c[l], d[l]);
    }
}

/* Adds samples to the two values of one pixel: see sum.h. One work-item. */
kernel void sum_samples(const global float4 *lights, const uint samples, const uint adds, global float4 *film)
{
    for (uint s = 0; s < samples; ++s) rt_add_sample(film, 1, 0, lights[s], adds == 0u && s == 0u);
}
