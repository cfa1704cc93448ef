/* bvh2.cl -- traversal of a binary BVH with the boxes of both children in each node, for any number of lanes.
 *
 * Aila, Laine 2009, "Understanding the Efficiency of Ray Traversal on GPUs": 64 bytes a node, so that one fetch decides on both
 * children. The nearer child is visited next, the other is deferred. The stack has the deferred node and the lanes' entry
 * distances, so that a child beyond the nearest hits is skipped without a look at it. Stack: an entry a level, 4 bytes and 4
 * for each lane.
 *
 * The loop is its own, and not that of cl/lanes/packet_traversal.h, with which packets of 16 lanes were 8 to 10 % slower. */
void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    vfloat stack_entry[BVH2_STACK];
    uint stack_ref[BVH2_STACK];
    uint top = 0, ref = root;
    uint inside = rt_bits(RT_MASK(hit->t >= rt_vfloat(0.0f))); /* lanes in the node, for programs that count */
    for (;;) {
        if (ref & BVH2_LEAF) {
            const uint first = BVH2_LEAF_FIRST(ref), count = BVH2_LEAF_COUNT(ref);
            for (uint i = 0; i < count; ++i) RT_LEAF(ctx, first + i, ray, hit);
#if RT_ANY_HIT
            if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return;
#endif
        } else {
            RT_COUNT_VISIT(hit, inside);
            const global bvh2_node *node = RT_NODE(ray, ctx->bvh2_nodes + ref);
            vfloat t0, t1;
#if RT_LANES == 1
            const global float4 *rows = (const global float4 *)node; /* 16-byte loads */
            const float4 a = rows[0], b = rows[1], c = rows[2], d = rows[3];
            const vmask in0 = rt_enter_bounds(a.x, a.y, a.z, a.w, b.x, b.y, ray, hit, &t0);
            const vmask in1 = rt_enter_bounds(c.x, c.y, c.z, c.w, d.x, d.y, ray, hit, &t1);
            const uint child0 = as_uint(b.z), child1 = as_uint(d.z);
#else
            const vmask in0 = rt_enter_box(node->box0, ray, hit, &t0);
            const vmask in1 = rt_enter_box(node->box1, ray, hit, &t1);
            const uint child0 = node->child0, child1 = node->child1;
#endif
            const uint bits0 = rt_bits(in0), bits1 = rt_bits(in1);
            if (bits0 != 0u && bits1 != 0u) {
                /* The child that more lanes enter first is visited first. */
                const uint both = bits0 & bits1;
                const bool swap = popcount(rt_bits(RT_MASK(t1 < t0)) & both) * 2u > popcount(both);
                stack_ref[top] = swap ? child0 : child1;
                stack_entry[top] = swap ? rt_select(in0, t0, RT_INFINITY) : rt_select(in1, t1, RT_INFINITY);
                if (RT_STACK_OK(top + 1u, BVH2_STACK, hit)) ++top;
                ref = swap ? child1 : child0;
                inside = swap ? bits1 : bits0;
                continue;
            }
            if ((bits0 | bits1) != 0u) {
                ref = bits0 != 0u ? child0 : child1;
                inside = bits0 | bits1;
                continue;
            }
        }
        do {
            if (top == 0u) return;
            --top;
            inside = rt_bits(RT_MASK(stack_entry[top] <= hit->t));
        } while (inside == 0u);
        ref = stack_ref[top];
    }
}
