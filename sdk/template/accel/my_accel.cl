/* my_accel.cl -- tests the box of every block, and if a ray hits the box, the primitives of the block. One call traces all lanes of
 * a packet, see CONTRACT.md. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const uint first = ctx->my_accel_runs[root].first, end = first + ctx->my_accel_runs[root].count;
    for (uint at = first; at < end; ++at) {
        const global my_accel_block *block = RT_NODE(ray, ctx->my_accel_blocks + at);
        vfloat entry;
        const uint inside = rt_bits(rt_enter_box(block->box, ray, hit, &entry));
        RT_COUNT_VISIT(hit, inside);
        if (inside == 0u) continue;
        for (uint i = 0; i < block->count; ++i) RT_LEAF(ctx, block->first + i, ray, hit);
#if RT_ANY_HIT
        if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return; /* every lane has found a hit */
#endif
    }
}
