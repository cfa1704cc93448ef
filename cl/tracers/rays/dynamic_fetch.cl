/* dynamic_fetch.cl -- nearest hits of the host's rays, for single rays on a GPU: a work-item that is done with its ray fetches
 * another one while its warp goes on.
 *
 * Aila, Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs". Incoherent rays need very different numbers of
 * steps. A warp steps through nodes until a third of its rays are at leaves, and then through leaves too. Where its rays are at
 * both, it executes both branches. Coherent rays are slower by either measure.
 *
 * On NVIDIA's devices the work-items of a warp fetch together, by a ballot (subgroup.h); elsewhere each fetches by itself. Hits
 * do not depend on the order of visits, so answers are bit for bit those of rays.cl. */
#define RT_MIN_ACTIVE ((RT_SUBGROUP_SIZE + 1u) / 2u) /* with fewer active rays, new ones are fetched */
#define RT_NO_RAY 0xFFFFFFFFu

/* Traces the rays [first, end). queue[parity]: the number of rays fetched in this launch; the other element, that of the next
 * launch, is cleared. share: the mean number of rays that a work-item of a warp fetches at a time. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_dynamic_fetch(const constant rt_frame *frame, const uint first, const uint end, const uint share,
                    const uint fields, const uint stride, const uint before,
             const global float *rays, global float *answers, volatile global uint *queue, const uint parity,
             RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    /* Begin and end of the rays that each subgroup has fetched and not begun. In local memory, because steps need the
     * registers. */
    volatile local uint fetched[RT_LOCAL_SIZE / RT_SUBGROUP_SIZE][2];
    volatile local uint *range = fetched[(uint)get_local_id(0) / RT_SUBGROUP_SIZE];
    range[0] = range[1] = first;
    if (get_global_id(0) == 0) queue[parity ^ 1u] = 0u;
    const uint before_me = (1u << rt_subgroup_local_id()) - 1u;
    rt_step_entry stack[RT_STEP_STACK_SIZE];
    uint top = 0u, at = RT_STEP_DONE, index = RT_NO_RAY;
    rt_rays ray;
    rt_step_ray step_ray;
    rt_hits hit;
    for (;;) {
        uint next = range[0], next_end = range[1]; /* read before the ballot: they are written after it */
        const bool idle = at == RT_STEP_DONE;
        const uint idle_bits = rt_subgroup_ballot(idle);
        if (next >= next_end && next_end < end) {
            uint from = 0u;
            if (rt_subgroup_local_id() == 0u) from = atomic_add(queue + parity, share * RT_SUBGROUP_SIZE);
            next = min(first + rt_subgroup_broadcast(0u, from), end);
            next_end = min(next + share * RT_SUBGROUP_SIZE, end);
        }
        if (idle) {
            if (index != RT_NO_RAY) {
                RT_COUNT_OVERFLOW(&hit)
                hit.t = hit.prim >= 0 ? hit.t * rt_scale_of_block(rays, index) : INFINITY;
                rt_store_hit_block(answers, index, fields, stride, before, &hit);
            }
            index = next + popcount(idle_bits & before_me);
            if (index < next_end) {
                float t_max;
                rt_load_ray_block(frame, rays, index, &ray, &t_max);
                rt_clear_hits(&hit, -1);
                if (t_max >= 0.0f) {
                    hit.t = t_max;
                    rt_prepare(&ray, 1u);
#if RT_HAS_PLANES
                    rt_hit_planes_closest(&ctx, frame->plane_count, &ray, &hit);
#endif
                    at = rt_begin_steps(frame->root, &ray, &step_ray, stack, &top);
                }
            } else
                index = RT_NO_RAY;
        }
        next = min(next + popcount(idle_bits), next_end);
        range[0] = next;
        range[1] = next_end;
        const bool last = next >= next_end && next_end >= end;
        uint at_nodes = rt_subgroup_ballot(!RT_STEP_IS_LEAF(at));
        uint at_leaves = rt_subgroup_ballot(RT_STEP_IS_LEAF(at) && at != RT_STEP_DONE);
        if (last && rt_subgroup_ballot(index != RT_NO_RAY) == 0u) break;
        const uint min_active = last ? 1u : RT_MIN_ACTIVE;
        while (popcount(at_nodes | at_leaves) >= min_active) {
            const bool leaves_too = 3u * popcount(at_leaves) >= popcount(at_nodes | at_leaves);
            if (!RT_STEP_IS_LEAF(at) || (leaves_too && at != RT_STEP_DONE))
                at = rt_scene_closest_step(&ctx, at, &ray, &step_ray, &hit, stack, &top);
            at_nodes = rt_subgroup_ballot(!RT_STEP_IS_LEAF(at));
            at_leaves = rt_subgroup_ballot(RT_STEP_IS_LEAF(at) && at != RT_STEP_DONE);
        }
    }
}
