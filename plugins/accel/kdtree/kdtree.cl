/* kdtree.cl -- one ray through a kd-tree, nearest cells first (Havran 2000, "Heuristic Ray Shooting Algorithms", TA_rec_B).
 *
 * `now` is the node, with the distances between which the ray is in it. It crosses the plane between `earliest` and `latest`, so
 * it visits both children unless that is surely behind or beyond. The stack has the farther child. */
#include "cl/lanes/mailbox.h"
#include "cl/lanes/span_stack.h"

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    rt_span stack[KDTREE_STACK], now;
    const global kdtree_head *head = RT_NODE(ray, ctx->kdtree_heads + root);
    uint top = 0u;
    now.node = head->node;
    RT_COUNT_VISIT(hit, 1u); /* the tree's box */
    if (!rt_enter_exit(head->box, ray, hit, &now.from, &now.to)) return;
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    for (;;) {
        const kdtree_node node = *RT_NODE(ray, ctx->kdtree_nodes + now.node);
        const uint axis = node.code & 3u;
        RT_COUNT_VISIT(hit, 1u);
        if (axis != KDTREE_LEAF) {
            /* Bits are tested, not the axis: oclgrind 21.10 misreads the switch over two bits which would come of it. */
            const float inverse = axis & 2u ? ray->iz : axis & 1u ? ray->iy : ray->ix;
            const float near = axis & 2u ? ray->near_z : axis & 1u ? ray->near_y : ray->near_x;
            const float far = axis & 2u ? ray->far_z : axis & 1u ? ray->far_y : ray->far_x;
            const float earliest = fma(inverse, node.at.split, near), latest = fma(inverse, node.at.split, far) * RT_WIDE;
            const uint above = inverse < 0.0f ? 1u : 0u, nearer = (node.code >> 2) + above, farther = (node.code >> 2) + 1u - above;
            now.node = nearer;
            if (latest < now.from) {
                now.node = farther;
            } else if (!(earliest > now.to)) {
                stack[top].node = farther;
                stack[top].from = rt_max(earliest, now.from);
                stack[top].to = now.to;
                if (RT_STACK_OK(top + 1u, KDTREE_STACK, hit)) ++top;
                now.to = rt_min(latest, now.to);
            }
            continue;
        }
        for (uint i = node.at.first, end = i + (node.code >> 2); i < end; ++i) {
            const uint place = ctx->kdtree_list[i];
            if (!rt_was_tested(&tested, place)) RT_LEAF(ctx, place, ray, hit);
        }
        if (!rt_pop_span(stack, &top, hit->t, &now)) return;
    }
}
