/* dynamic_fetch.cl -- nearest hits of rays that the host brings, for single rays on a GPU: work-items that are done with a ray draw
 * another while their warp goes on, for rays that part need very different numbers of turns (Aila, Laine 2009, "Understanding the
 * Efficiency of Ray Traversal on GPUs"). A warp steps through nodes until a third of its rays are at leaves, and then takes those
 * too: it runs both ways where its rays are not at one of them. Rays that keep together lose by either.
 *
 * On NVIDIA's devices a warp agrees by ballot (subgroup.h); elsewhere a work-item draws by itself. Answers are those of rays.cl bit for
 * bit, for hits do not depend on the order of visits. */
#define RT_BUSY_LEAST ((RT_SUBGROUP_SIZE + 1u) / 2u) /* with fewer rays on their way, new ones are drawn */
#define RT_NO_RAY 0xFFFFFFFFu

/* Rays first..end - 1. queue: how many were drawn, in this launch and in the next, for which it is cleared, in turn. share: how many
 * each work-item of a warp draws at a time, in the mean. */
kernel __attribute__((reqd_work_group_size(RT_LOCAL_SIZE, 1, 1))) void
trace_dynamic_fetch(const constant rt_frame *frame, const uint first, const uint end, const uint share, const uint fields,
             const global float *rays, global float *answers, volatile global uint *queue, const uint turn,
             RT_OVERFLOWS_PARAM RT_CTX_PARAMS)
{
    RT_CTX_INIT(ctx);
    /* Where those begin and end that were drawn and not begun; not in registers, which the turns need more. */
    volatile local uint drawn[RT_LOCAL_SIZE / RT_SUBGROUP_SIZE][2];
    volatile local uint *own = drawn[(uint)get_local_id(0) / RT_SUBGROUP_SIZE];
    own[0] = own[1] = first;
    if (get_global_id(0) == 0) queue[turn ^ 1u] = 0u;
    const uint before_me = (1u << rt_subgroup_local_id()) - 1u;
    rt_step_entry stack[RT_STEP_STACK_SIZE];
    uint top = 0u, at = RT_STEP_DONE, mine = RT_NO_RAY;
    rt_rays ray;
    rt_step_ray turns;
    rt_hits hit;
    for (;;) {
        uint next = own[0], next_end = own[1]; /* before the vote, for it is after it that somebody writes them */
        const bool idle = at == RT_STEP_DONE;
        const uint idlers = rt_subgroup_ballot(idle);
        if (next >= next_end && next_end < end) {
            uint from = 0u;
            if (rt_subgroup_local_id() == 0u) from = atomic_add(queue + turn, share * RT_SUBGROUP_SIZE);
            next = min(first + rt_subgroup_broadcast(0u, from), end);
            next_end = min(next + share * RT_SUBGROUP_SIZE, end);
        }
        if (idle) {
            if (mine != RT_NO_RAY) {
                RT_COUNT_OVERFLOW(&hit)
                hit.t = hit.prim >= 0 ? hit.t : INFINITY;
                rt_store_hit_block(answers, mine, fields, &hit);
            }
            mine = next + popcount(idlers & before_me);
            if (mine < next_end) {
                float t_max;
                rt_load_ray_block(rays, mine, &ray, &t_max);
                rt_clear_hits(&hit, -1);
                if (t_max >= 0.0f) {
                    hit.t = t_max;
                    rt_prepare(&ray, 1u);
#if RT_HAS_PLANES
                    rt_hit_planes_closest(&ctx, frame->plane_count, &ray, &hit);
#endif
                    at = rt_begin_steps(frame->root, &ray, &turns, stack, &top);
                }
            } else
                mine = RT_NO_RAY;
        }
        next = min(next + popcount(idlers), next_end);
        own[0] = next;
        own[1] = next_end;
        const bool last = next >= next_end && next_end >= end;
        uint at_nodes = rt_subgroup_ballot(!RT_STEP_IS_LEAF(at));
        uint at_leaves = rt_subgroup_ballot(RT_STEP_IS_LEAF(at) && at != RT_STEP_DONE);
        if (last && rt_subgroup_ballot(mine != RT_NO_RAY) == 0u) break;
        const uint least = last ? 1u : RT_BUSY_LEAST;
        while (popcount(at_nodes | at_leaves) >= least) {
            const bool leaves_too = 3u * popcount(at_leaves) >= popcount(at_nodes | at_leaves);
            if (!RT_STEP_IS_LEAF(at) || (leaves_too && at != RT_STEP_DONE))
                at = rt_scene_closest_step(&ctx, at, &ray, &turns, &hit, stack, &top);
            at_nodes = rt_subgroup_ballot(!RT_STEP_IS_LEAF(at));
            at_leaves = rt_subgroup_ballot(RT_STEP_IS_LEAF(at) && at != RT_STEP_DONE);
        }
    }
}
