/* frame_parts.cl -- the first parts of a frame, for `clarity bench --breakdown`.
 *
 * RT_PART 0 writes the film alone, 1 makes camera rays too, 2 finds their nearest hits too. Arguments and order of work are
 * those of iterative.cl. The results go into the picture, so that the compiler cannot remove any work. */
RT_PICTURE_KERNEL
trace_parts(const constant rt_frame *frame, const uint first_group, global float4 *film, global uint4 *counters,
            global float *distances, RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint group = first_group + (uint)get_group_id(0);
    const uint packet_w = RT_PACKET_W(frame), blocks = RT_BLOCKS(frame);
    float4 sums[RT_MAX_PIXELS];
    RT_FOR_PACKETS(frame, packet)
    {
        const uint2 origin = rt_packet_origin(frame, group, packet);
        const uint number = group * RT_GROUP_PACKETS(frame) + packet;
#if RT_PART >= 1
        const bool empty = rt_only_background(frame, origin, sums, distances + (size_t)number * blocks * RT_LANES);
#else
        const bool empty = false;
#endif
        RT_FOR_STREAMS(base, 0u, empty ? 0u : blocks) {
            const uint count = RT_STREAM_OF(blocks - base);
            rt_rays rays[RT_STREAM];
            rt_hits hits[RT_STREAM];
#if RT_PART >= 1
            RT_FOR_EACH_PACKET(b, count) {
                vint in_x, in_y;
                const vmask active = rt_block_pixels(frame, origin, base + b, &in_x, &in_y);
                rt_camera_rays(frame, in_x + rt_vint((int)origin.x), in_y + rt_vint((int)origin.y), rays + b);
                rt_prepare(rays + b, rt_bits(active));
                rt_clear_hits(hits + b, active);
            }
#endif
#if RT_PART >= 2
            rt_trace_stream_closest(&ctx, frame, rays, hits, count);
#endif
            RT_FOR_EACH_PACKET(b, count) {
                vint in_x, in_y;
                const uint bits = rt_bits(rt_block_pixels(frame, origin, base + b, &in_x, &in_y));
                rt_vec light = rt_splat(frame->background[0], frame->background[1], frame->background[2]);
#if RT_PART >= 1
                const rt_rays *ray = rays + b;
                light.x += ray->near_x + ray->far_x + ray->ix + ray->sx;
                light.y += ray->near_y + ray->far_y + ray->iy + ray->sy;
                light.z += ray->near_z + ray->far_z + ray->iz + ray->sz;
#endif
#if RT_PART >= 2
                const rt_hits *hit = hits + b;
                if (frame->sample == 0u) rt_store(hit->t, distances + ((size_t)number * blocks + base + b) * RT_LANES);
                light.x += hit->nx + rt_to_float(hit->leaf);
                light.y += hit->ny + rt_to_float(hit->prim);
                light.z += hit->nz + rt_to_float(hit->instance);
#if RT_HAS_ATTRIBUTES || RT_HAS_TEXTURES
                light.x += hit->u;
                light.y += hit->v;
#endif
#endif
                rt_begin_pixels(frame, light, in_y * rt_vint((int)packet_w) + in_x, bits, sums);
            }
        }
        rt_put_pixels(frame, origin, sums, film);
        counters[number] = (uint4)(0u);
    }
}
