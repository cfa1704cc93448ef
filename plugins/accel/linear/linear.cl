/* linear.cl -- a list: tests every primitive in order. The reference for all other structures. No nodes, no stack. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const global linear_run *run = RT_NODE(ray, ctx->linear_runs + root);
    const uint first = run->first, count = run->count;
    RT_COUNT_STEP(hit);
    for (uint i = 0; i < count; ++i) {
        RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
        if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
    }
}
