/* iterative_single.h -- generations.h for one pixel and one lane a work-item, as on GPUs: the same rays in the same order, so
 * the same sums.
 *
 * A mirrored ray takes the registers of the ray that hit the mirror. The arrays lie in private memory, which is as slow as any
 * other on a GPU. They hold only deferred rays: none without glass. There is one loop for all generations. With a loop for
 * each, a warp would wait for the pixel with the most rays in each generation; here it waits for the pixel with the most rays
 * in all. */
#ifndef RT_ITERATIVE_SINGLE_H
#define RT_ITERATIVE_SINGLE_H

/* Both rays of a surface have come as far as `next_ray`. */
RT_INLINE uint rt_put_ray(rt_queue *next, uint count, const rt_rays *next_ray, rt_vec origin, rt_vec direction, rt_vec weight, rt_tally *tally)
{
    const uint more = rt_append(next, RT_RAY_SLOTS, count, 1u, origin, direction, weight, 0, &tally->dropped);
    RT_KEEP_CONE(next, count, more, next_ray->travelled, 1u)
    return more;
}

RT_INLINE void rt_trace_generations(const rt_ctx *ctx, const constant rt_frame *frame, uint2 origin, rt_queue *queues, float4 *sums,
                                    global float *distance, rt_tally *tally)
{
    rt_vec sum = rt_splat(0.0f, 0.0f, 0.0f), weight = rt_splat(1.0f, 1.0f, 1.0f);
    rt_rays ray;
    int x, y;
    uint count = rt_bits(rt_block_pixels(frame, origin, 0u, &x, &y));
    rt_camera_rays(frame, x + (int)origin.x, y + (int)origin.y, &ray);

    /* The ray in registers is number `at` of the `count` of its generation. The next generation has next_count rays so far. Its
     * ray 0 may be in registers; then its element of the array is empty. */
    for (uint generation = 0, at = 0, next_count = 0; count != 0u;) {
        rt_hits hit;
        RT_SEEN_BY(&ray, generation == 0u ? RT_SEEN_BY_CAMERA : RT_SEEN_BY_MIRROR)
        rt_prepare(&ray, 1u);
        rt_clear_hits(&hit, -1);
        rt_trace_closest(ctx, frame, &ray, &hit);
#ifdef RT_HAS_CUTOUTS
        rt_pass_cutouts(ctx, frame, 0, 0, &ray, &hit, -1, &tally->dropped);
#endif
        RT_TALLY_OVERFLOW(tally, &hit)
        if (generation == 0u && frame->sample == 0u) *distance = hit.t;

        rt_vec light;
        rt_deferred deferred;
        uint splits;
        const vmask last = RT_MASK(generation + 1u >= frame->depth);
        const vmask next_lanes = rt_step(ctx, frame, -1, last, &ray, &hit, &weight, &light, &deferred, &splits, tally);
        sum = rt_add(sum, light);

        rt_queue *next = queues + (1u - (generation & 1u));
        const bool stays = next_lanes && at + 1u == count && next_count == 0u;
        if (stays)
            next_count = 1u;
        else if (next_lanes)
            next_count = rt_put_ray(next, next_count, &ray, rt_vec_of(ray.ox, ray.oy, ray.oz), rt_vec_of(ray.dx, ray.dy, ray.dz), weight, tally);
        if (splits != 0u) next_count = rt_put_ray(next, next_count, &ray, deferred.origin, deferred.direction, deferred.weight, tally);
        if (++at == count) {
            tally->secondary += next_count;
            count = next_count;
            at = next_count = 0u;
            ++generation;
        }
        if (count != 0u && !stays) {
            int pixel;
            rt_take(queues + (generation & 1u), at, &ray, &weight, &pixel);
        }
    }
    *sums = (float4)(sum.x, sum.y, sum.z, 1.0f);
}

#endif
