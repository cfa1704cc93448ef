/* inspect.cl -- traces one packet and records the rays of one of its pixels: see recorder.h. */

/* Launched with one work-group. packet_wanted: the index of the packet in the group. pixel: the index in the packet of the
 * pixel to record. records: `capacity` elements. summary: the number of rays, which may exceed capacity; then the pixel's
 * colour, as three bit patterns of floats; then the number of full stacks (debug programs). */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_inspect(const constant rt_frame *frame, const uint group, const uint packet_wanted, const uint pixel,
              global rt_ray_record *records, const uint capacity, global uint *summary, global float *distances, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    rt_queue queues[2];
    float4 sums[RT_MAX_PIXELS];
    RT_FOR_PACKETS(frame, packet)
    {
        if (packet != packet_wanted) continue;
        rt_tally tally = {0, 0, 0, 0};
        tally.recorder.records = records;
        tally.recorder.count = 0u;
        tally.recorder.capacity = capacity;
        tally.recorder.pixel = (int)pixel;
        tally.recorder.too_deep = 0;
        rt_trace_generations(&ctx, frame, rt_packet_origin(frame, group, packet), queues, sums, distances, &tally);
        summary[0] = tally.recorder.count;
        summary[1] = as_uint(sums[pixel].x);
        summary[2] = as_uint(sums[pixel].y);
        summary[3] = as_uint(sums[pixel].z);
        summary[4] = tally.overflow;
    }
}
