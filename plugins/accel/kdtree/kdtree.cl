/* kdtree.cl -- one ray through a kd-tree, nearest cells first (Havran 2000, "Heuristic Ray Shooting Algorithms", TA_rec_B).
 *
 * `now` is the node, with the distances between which the ray is in it. It crosses the plane between `earliest` and `latest`, so
 * it visits both children unless that is surely behind or beyond. The stack has the farther child.
 *
 * A packet whose directions agree in sign meets the same child of each node first, so it goes through the tree together (Wald,
 * Slusallek, Benthin, Wagner 2001, "Interactive Rendering with Coherent Ray Tracing"). A lane is in the node if `from` <= `to`. */
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

#if RT_LANES > 1
bool RT_CAT(RT_TRAVERSE, _packet)(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    if (!ray->coherent) return false;
    uint stack_node[KDTREE_STACK], top = 0u;
    vfloat stack_from[KDTREE_STACK], stack_to[KDTREE_STACK], from, to;
    const global kdtree_head *head = RT_NODE(ray, ctx->kdtree_heads + root);
    const vmask enters = rt_enter_exit(head->box, ray, hit, &from, &to);
    RT_COUNT_VISIT(hit, rt_bits(enters));
    if (!rt_any(enters)) return true;
    to = rt_select(enters, to, rt_vfloat(-MAXFLOAT));
    const vfloat inverse[3] = {ray->ix, ray->iy, ray->iz}, near[3] = {ray->near_x, ray->near_y, ray->near_z},
                 far[3] = {ray->far_x, ray->far_y, ray->far_z};
    const uint above[3] = {ray->lo_x > 2u, ray->lo_y > 2u, ray->lo_z > 2u}; /* whether the child above a plane is the nearer one */
    uint at = head->node;
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    for (;;) {
        const kdtree_node node = *RT_NODE(ray, ctx->kdtree_nodes + at);
        const uint axis = node.code & 3u;
        const vmask inside = RT_MASK(from <= to);
        RT_COUNT_VISIT(hit, rt_bits(inside));
        if (axis != KDTREE_LEAF) {
            const vfloat split = rt_vfloat(node.at.split), earliest = fma(inverse[axis], split, near[axis]),
                         latest = fma(inverse[axis], split, far[axis]) * rt_vfloat(RT_WIDE);
            const uint nearer = (node.code >> 2) + above[axis], farther = (node.code >> 2) + 1u - above[axis];
            if (!rt_any(inside & ~RT_MASK(latest < from))) {
                at = farther;
            } else {
                at = nearer;
                if (rt_any(inside & ~RT_MASK(earliest > to))) {
                    stack_node[top] = farther;
                    stack_from[top] = rt_max(earliest, from);
                    stack_to[top] = to;
                    if (RT_STACK_OK(top + 1u, KDTREE_STACK, hit)) ++top;
                    to = rt_min(latest, to);
                }
            }
            continue;
        }
        for (uint i = node.at.first, end = i + (node.code >> 2); i < end; ++i) {
            const uint place = ctx->kdtree_list[i];
            if (!rt_was_tested(&tested, place)) RT_PACKET_LEAF(ctx, place, ray, hit);
        }
#if RT_ANY_HIT
        if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return true;
#endif
        do {
            if (top == 0u) return true;
            --top;
            from = stack_from[top];
            to = rt_min(stack_to[top], hit->t);
        } while (!rt_any(RT_MASK(from <= to)));
        at = stack_node[top];
    }
}
#endif
