/* iterative.cl -- a sample of every pixel by generations of rays, packet by packet: see generations.h. */

/* film: the sums of samples, with their number in w; with RT_SHOW_GENERATIONS one number a pixel, of this sample. counters:
 * shadow, secondary and dropped rays and full stacks of each packet. distances: those of sample 0's camera rays, packet by
 * packet, block by block, RT_LANES each. That is one store a block, where the picture's order would take one a pixel; the
 * reader puts them in order. */
#ifdef RT_SHOW_GENERATIONS
typedef float rt_film;
#else
typedef float4 rt_film;
#endif

RT_GROUP_WORK void rt_iterative_group(const rt_ctx *scene, const constant rt_frame *frame, uint launched, global rt_film *film,
                                      global uint4 *counters, global float *distances)
{
    const rt_ctx ctx = *scene;
    uint group = launched;
    const uint layer = rt_layer_of(frame, &group);
    const uint rays = RT_BLOCKS(frame) * RT_LANES;
    frame += layer;
    film += (size_t)layer * frame->width * frame->height;
    rt_queue queues[2];
    float4 sums[RT_MAX_PIXELS];
    RT_FOR_PACKETS(frame, packet)
    {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        const uint number = group * RT_GROUP_PACKETS(frame) + packet;
        rt_tally tally = {0, 0, 0, 0};
        rt_trace_generations(&ctx, frame, origin, queues, sums, distances + (size_t)number * rays, &tally);

#ifdef RT_SHOW_GENERATIONS
        const uint packet_w = RT_PACKET_W(frame);
        for (uint i = 0; i < packet_w * RT_PACKET_H(frame); ++i) {
            const uint x = origin.x + i % packet_w, y = origin.y + i / packet_w;
            if (x < frame->width && y < frame->height) film[y * frame->width + x] = sums[i].x;
        }
#else
        rt_put_pixels(frame, origin, sums, film);
#endif
        counters[launched * RT_GROUP_PACKETS(frame) + packet] = (uint4)(tally.shadow, tally.secondary, tally.dropped, tally.overflow);
    }
}

RT_PICTURE_KERNEL
trace_iterative(const constant rt_frame *frame, RT_GROUPS_PARAMS global rt_film *film, global uint4 *counters,
                global float *distances, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    RT_FOR_GROUPS(group) rt_iterative_group(&ctx, frame, group, film, counters, distances);
}
