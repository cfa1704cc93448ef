/* requeued_rays.cl -- traces the host's rays in two launches, for single rays on a GPU: long rays are queued for the second.
 *
 * Where rays do not fill the device, a launch lasts as long as its slowest warps, and these wait for the few rays that graze
 * hundreds of triangles. trace_short gives each ray RT_STEP_BUDGET steps of its traversal and lists those that need more.
 * trace_long_* begin these again at the root, with the nearest hit found so far. RT_REQUEUE_ITEMS work-items trace one ray:
 * they take in parallel the steps that had to follow each other. Hits do not depend on the order of visits, so answers are bit
 * for bit those of rays.cl.
 *
 * list[parity]: the number of long rays of this launch; the other of its first two elements, that of the next launch, is
 * cleared. Then the indices of the rays. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_short(const constant rt_frame *frame, const uint first_group, const uint count, const uint any_hit,
            const uint fields, const uint stride, const uint before,
            const global float *rays, global float *answers, volatile global uint *list, const uint parity,
            RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    const uint at = (first_group + (uint)get_group_id(0)) * RT_LOCAL_SIZE + (uint)get_local_id(0);
    if (get_global_id(0) == 0) list[parity ^ 1u] = 0u;
    if (at >= count) return;
    rt_rays ray;
    rt_hits hit;
    float t_max;
    rt_load_ray_block(frame, rays, at, &ray, &t_max);
    rt_clear_hits(&hit, -1);
    if (t_max >= 0.0f) {
        hit.t = t_max;
        hit.step_budget = RT_STEP_BUDGET;
        rt_prepare(&ray, 1u);
        if (any_hit) {
            rt_trace_any(&ctx, frame, &ray, &hit);
            hit.t = hit.t < 0.0f ? 0.0f : INFINITY;
        } else {
            rt_trace_closest(&ctx, frame, &ray, &hit);
            hit.t = hit.prim >= 0 ? hit.t * rt_scale_of_block(rays, at) : INFINITY;
        }
        if (hit.step_budget < 0 && !(any_hit && hit.t == 0.0f)) list[2u + atomic_inc(list + parity)] = at;
    }
    RT_COUNT_OVERFLOW(&hit)
    rt_store_hit_block(answers, at, fields, stride, before, &hit);
}

#define RT_LONG_KERNEL kernel __attribute__((reqd_work_group_size(RT_REQUEUE_ITEMS, 1, 1))) void

RT_LONG_KERNEL
trace_long_closest(const constant rt_frame *frame,
                   const uint fields, const uint stride, const uint before, const global float *rays, global float *answers,
                   const global uint *list, const uint parity, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    local rt_requeue_scratch scratch;
    local uint nearest, lowest;
    const uint count = list[parity];
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        const uint at = list[2u + i];
        rt_rays ray;
        rt_hits hit;
        float t_max;
        rt_load_ray_block(frame, rays, at, &ray, &t_max);
        rt_prepare(&ray, 1u);
        rt_clear_hits(&hit, -1);
        hit.step_budget = INT_MAX;
        const float known = answers[before + at] * RT_INVERSE_POWER(rt_scale_of_block(rays, at));
        hit.t = fmin(t_max, known);
        if (known < INFINITY) hit.prim = as_int(answers[stride + (size_t)before + at]);
        if (get_local_id(0) == 0) nearest = lowest = 0x7FFFFFFFu;
        rt_scene_long_closest(&ctx, frame->root, &ray, &hit, &scratch);
        RT_COUNT_OVERFLOW(&hit)
        /* Several work-items may have found a hit. The nearest one counts. */
        const bool found = hit.leaf != -1;
        if (found) atomic_min(&nearest, as_uint(hit.t));
        barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
        if (found && as_uint(hit.t) == nearest) atomic_min(&lowest, (uint)hit.prim);
        barrier(CLK_LOCAL_MEM_FENCE);
        if (found && as_uint(hit.t) == nearest && (uint)hit.prim == lowest) {
            hit.t *= rt_scale_of_block(rays, at);
            rt_store_hit_block(answers, at, fields, stride, before, &hit);
        }
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}

/* A kernel of its own, because PoCL 3.1 loses work-items where there are barriers under a condition. */
RT_LONG_KERNEL
trace_long_any(const constant rt_frame *frame,
               const uint fields, const uint stride, const uint before, const global float *rays, global float *answers,
               const global uint *list, const uint parity, RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    local rt_requeue_scratch scratch;
    const uint count = list[parity];
    for (uint i = (uint)get_group_id(0); i < count; i += (uint)get_num_groups(0)) {
        const uint at = list[2u + i];
        rt_rays ray;
        rt_hits hit;
        rt_load_ray_block(frame, rays, at, &ray, &hit.t);
        rt_prepare(&ray, 1u);
        hit.step_budget = INT_MAX;
        RT_CLEAR_OVERFLOW(&hit)
        rt_scene_long_any(&ctx, frame->root, &ray, &hit, &scratch);
        RT_COUNT_OVERFLOW(&hit)
        if (get_local_id(0) == 0 && scratch.nearest == 0u) answers[before + at] = 0.0f;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
}
