/* path.cl -- samples of every pixel by paths of light: a path is one ray at a time, from the camera on.
 *
 * A lane whose path has ended takes the next pixel of the packet (state.h), so that all lanes have work until few pixels are
 * left. There is no queue of rays. A work-item of one lane does the same with the samples of its pixel. */

/* Traces the packets of a group of the launch. film: two planes, see sum.h, and those of guides.h. counters: of each packet, shadow rays, rays after the camera's,
 * samples that are not finite, and rays that were stopped by RT_MOST_PASSED cut-outs (debug programs: full stacks). distances: those of sample 0's camera rays, as in iterative.cl. */
RT_GROUP_WORK void rt_path_group(const rt_ctx *scene, const constant rt_frame *frame, uint group, global float4 *film, global uint4 *counters,
                                 global float *distances)
{
    const rt_ctx ctx = *scene;
    const uint rays = RT_BLOCKS(frame) * RT_LANES;
    RT_FOR_PACKETS(frame, packet)
    {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        const uint number = group * RT_GROUP_PACKETS(frame) + packet;
        rt_tally tally = {0, 0, 0, 0};
        uint not_finite = 0;
        rt_path paths = rt_no_paths(frame);
        RT_GUIDE(paths.guides = film + RT_PLANE_OWN * (size_t)frame->width * frame->height)
        for (uint next = 0;;) {
            rt_refill(frame, film, origin, &paths, &next);
            if (!rt_any(paths.alive)) break;
            const vmask on = rt_trace_segment(&ctx, frame, &paths, distances + (size_t)number * rays, &tally);
            rt_end_paths(frame, &paths, rt_bits(paths.alive & ~on), film, &not_finite);
            paths.alive = on;
        }
#ifdef RT_DEBUG
        const uint last = tally.overflow;
#else
        const uint last = tally.dropped;
#endif
        counters[number] = (uint4)(tally.shadow, tally.secondary, not_finite, last);
    }
}

RT_PICTURE_KERNEL
trace_path(const constant rt_frame *frame, RT_GROUPS_PARAMS global float4 *film, global uint4 *counters, global float *distances,
           RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    RT_FOR_GROUPS(group) rt_path_group(&ctx, frame, group, film, counters, distances);
}
