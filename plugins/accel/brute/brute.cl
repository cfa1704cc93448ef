/* brute.cl -- all primitives for each ray, in parallel. No nodes, no stack.
 *
 * Where a work-item has a ray, it tests one primitive after the other, as `linear` does. Where a work-group has a ray, in the second
 * of two launches (cl/tracers/rays/requeued_rays.cl), each of its work-items tests every RT_REQUEUE_ITEMS-th primitive, and the
 * kernel takes the nearest of their hits. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const global brute_run *run = RT_NODE(ray, ctx->brute_runs + root);
    const uint first = run->first, count = run->count;
    RT_COUNT_STEP(hit);
    for (uint i = 0; i < count && RT_MAY_GO_ON(hit); ++i) {
        RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
        if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
    }
}

#ifdef RT_TRAVERSE_REQUEUED
void RT_TRAVERSE_REQUEUED(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit, local rt_requeue_scratch *shared)
{
    const uint first = ctx->brute_runs[root].first, count = ctx->brute_runs[root].count, item = (uint)get_local_id(0);
    if (item == 0u) shared->nearest = 1u;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint i = item; i < count; i += RT_REQUEUE_ITEMS) {
        RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
        if (hit->t < 0.0f) atomic_min(&shared->nearest, 0u);
        if (*(volatile local uint *)&shared->nearest == 0u) break;
#endif
    }
    barrier(CLK_LOCAL_MEM_FENCE);
}
#endif
