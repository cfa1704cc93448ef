/* octree.cl -- one ray through an octree, nearest cells first (Glassner 1984, "Space Subdivision for Fast Ray Tracing"; from the root
 * downwards as Revelles, Urena, Lastra 2000, "An Efficient Parametric Algorithm for Octree Traversal").
 *
 * The ray crosses each plane of a node between `earliest` and `latest`, so its span in a child begins and ends there. Children are
 * taken with the farthest first, in the order of the bits of the planes behind which they lie. The nearest is visited at once, the others
 * wait on the stack: 7 entries a level. */
#include "cl/lanes/mailbox.h"
#include "cl/lanes/span_stack.h"

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    rt_span stack[OCTREE_STACK], now;
    RT_COUNT_VISIT(hit, 1u); /* the tree's box */
    const global octree_head *head = RT_NODE(ray, ctx->octree_heads + root);
    if (!rt_enter_exit(head->box, ray, hit, &now.from, &now.to)) return;
    uint top = 0u;
    now.node = head->node;
    const uint nearest = (ray->ix < 0.0f ? 1u : 0u) | (ray->iy < 0.0f ? 2u : 0u) | (ray->iz < 0.0f ? 4u : 0u);
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    for (;;) {
        const octree_node node = *RT_NODE(ray, ctx->octree_nodes + now.node);
        RT_COUNT_VISIT(hit, 1u);
        if (node.code & OCTREE_LEAF) {
            for (uint i = node.at.first, end = i + (node.code & ~OCTREE_LEAF); i < end; ++i) {
                const uint place = ctx->octree_list[i];
                if (!rt_was_tested(&tested, place)) RT_LEAF(ctx, place, ray, hit);
            }
        } else {
            const float x = node.at.center[0], y = node.at.center[1], z = node.at.center[2];
            const float earliest_x = fma(ray->ix, x, ray->near_x), latest_x = fma(ray->ix, x, ray->far_x) * RT_WIDE;
            const float earliest_y = fma(ray->iy, y, ray->near_y), latest_y = fma(ray->iy, y, ray->far_y) * RT_WIDE;
            const float earliest_z = fma(ray->iz, z, ray->near_z), latest_z = fma(ray->iz, z, ray->far_z) * RT_WIDE;
            rt_span next = {RT_NONE, 0.0f, 0.0f}; /* the nearest child so far; the one before it waits */
            for (uint i = 8u; i-- > 0u;) {
                float begin = now.from, end = rt_min(now.to, hit->t);
                if (i & 1u) begin = rt_max(begin, earliest_x); else end = rt_min(end, latest_x);
                if (i & 2u) begin = rt_max(begin, earliest_y); else end = rt_min(end, latest_y);
                if (i & 4u) begin = rt_max(begin, earliest_z); else end = rt_min(end, latest_z);
                const uint child = node.code + (i ^ nearest);
                if (begin > end || ctx->octree_nodes[child].code == OCTREE_LEAF) continue;
                stack[top] = next;
                if (next.node != RT_NONE && RT_STACK_OK(top + 1u, OCTREE_STACK, hit)) ++top;
                next.node = child;
                next.from = begin;
                next.to = end;
            }
            if (next.node != RT_NONE) {
                now = next;
                continue;
            }
        }
        if (!rt_pop_span(stack, &top, hit->t, &now)) return;
    }
}
