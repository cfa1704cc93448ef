/* bvh2.cl -- binary BVH whose nodes hold the boxes of both children (Aila, Laine 2009, Understanding the Efficiency of Ray
 * Traversal on GPUs, layout of 64 bytes a node), written once for any lane count.
 * Stack: the node put off and the lanes' entry distances, so that what a nearer hit has made pointless is skipped unseen. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    vfloat stack_t[BVH2_STACK];
    uint stack_node[BVH2_STACK];
    uint top = 0, at = root;
    uint inside = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); /* lanes in the node, for counting programs */
    for (;;) {
        if (at & BVH2_LEAF) {
            const uint first = BVH2_LEAF_FIRST(at), count = BVH2_LEAF_COUNT(at);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, inside);
            const global bvh2_node *n = ctx->bvh2_nodes + at;
            vfloat t0, t1;
#if RT_LANES == 1
            const global float4 *q = (const global float4 *)n; /* 16-byte loads */
            const float4 a = q[0], b = q[1], c = q[2], d = q[3];
            const vmask in0 = rt_enter_bounds(a.x, a.y, a.z, a.w, b.x, b.y, ray, hit, &t0);
            const vmask in1 = rt_enter_bounds(c.x, c.y, c.z, c.w, d.x, d.y, ray, hit, &t1);
            const uint child0 = as_uint(b.z), child1 = as_uint(d.z);
#else
            const vmask in0 = rt_enter_box(n->box0, ray, hit, &t0);
            const vmask in1 = rt_enter_box(n->box1, ray, hit, &t1);
            const uint child0 = n->child0, child1 = n->child1;
#endif
            const uint any0 = rt_bits(in0), any1 = rt_bits(in1);
            if (any0 != 0u && any1 != 0u) {
                /* The child that more lanes meet first goes first. */
                const uint both = any0 & any1;
                const bool swap = popcount(rt_bits(RT_MASK(t1 < t0)) & both) * 2u > popcount(both);
                stack_node[top] = swap ? child0 : child1;
                stack_t[top] = swap ? rt_select(in0, t0, RT_INFINITY) : rt_select(in1, t1, RT_INFINITY);
                if (RT_STACK_OK(top + 1u, BVH2_STACK, hit)) ++top;
                at = swap ? child1 : child0;
                inside = swap ? any1 : any0;
                continue;
            }
            if (any0 != 0u) {
                at = child0;
                inside = any0;
                continue;
            }
            if (any1 != 0u) {
                at = child1;
                inside = any1;
                continue;
            }
        }
        do {
            if (top == 0u) return;
            --top;
            inside = rt_bits(RT_MASK(stack_t[top] <= hit->t));
        } while (inside == 0u);
        at = stack_node[top];
    }
}
