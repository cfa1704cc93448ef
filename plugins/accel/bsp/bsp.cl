/* bsp.cl -- one ray through a tree of planes, nearest cells first, as kdtree.cl goes through a kd-tree.
 *
 * At t the ray is n . (o + t d) - split above a plane, give or take what rounding makes of a place: 16 RT_EPS of |o|, 32 RT_EPS of |t d|
 * and 4 RT_FAR_SLACK (see "Slack" of CONTRACT.md, whose 8 and 16 are for tests of primitives; the builder rounds clipped corners, too). Both
 * bounds of that are linear in t, so each child has a span of its own, and the two overlap. Where a ray runs along a plane the spans are as
 * long as the node's: that is why a distance from the plane is bounded here, and not the t at which the ray meets it. */
#include "cl/lanes/mailbox.h"

/* Cuts a span to where a + t b <= 0. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _cut)(float a, float b, float *from, float *to)
{
    const float t = -a / b;
    if (b > 0.0f)
        *to = rt_min(*to, t * RT_WIDE);
    else if (b < 0.0f)
        *from = rt_max(*from, t * (2.0f - RT_WIDE));
    else if (a > 0.0f)
        *to = -1.0f;
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    bsp_entry stack[BSP_STACK];
    const global bsp_head *head = RT_NODE(ray, ctx->bsp_heads + root);
    uint top = 0u, at = head->node;
    float from, to;
    RT_COUNT_VISIT(hit, 1u); /* the tree's box */
    if (!rt_enter_exit(head->box, ray, hit, &from, &to)) return;
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    for (;;) {
        const bsp_node node = *RT_NODE(ray, ctx->bsp_nodes + at);
        const uint k = node.code & BSP_LEAF;
        RT_COUNT_VISIT(hit, 1u);
        if (k != BSP_LEAF) {
            const float x = BSP_COMPONENT(BSP_XS, k), y = BSP_COMPONENT(BSP_YS, k), z = BSP_COMPONENT(BSP_ZS, k);
            const float above = fma(x, ray->ox, fma(y, ray->oy, z * ray->oz)) - node.at.split, rise = fma(x, ray->dx, fma(y, ray->dy, z * ray->dz));
            const float slack = fma(fabs(x * ray->ox) + fabs(y * ray->oy) + fabs(z * ray->oz), 16.0f * RT_EPS, 4.0f * RT_FAR_SLACK);
            const float rising_slack = (fabs(x * ray->dx) + fabs(y * ray->dy) + fabs(z * ray->dz)) * (32.0f * RT_EPS);
            float below_from = from, below_to = to, above_from = from, above_to = to;
            RT_CAT(RT_TRAVERSE, _cut)(above - slack, rise - rising_slack, &below_from, &below_to);
            RT_CAT(RT_TRAVERSE, _cut)(-above - slack, -rise - rising_slack, &above_from, &above_to);
            const uint below = node.code >> 4;
            if (above_from > above_to) {
                at = below;
                from = below_from;
                to = below_to;
            } else if (below_from > below_to) {
                at = below + 1u;
                from = above_from;
                to = above_to;
            } else {
                const bool rises = rise > 0.0f;
                stack[top].node = rises ? below + 1u : below;
                stack[top].from = rises ? above_from : below_from;
                stack[top].to = rises ? above_to : below_to;
                if (RT_STACK_OK(top + 1u, BSP_STACK, hit)) ++top;
                at = rises ? below : below + 1u;
                from = rises ? below_from : above_from;
                to = rises ? below_to : above_to;
            }
            continue;
        }
        for (uint i = node.at.first, end = i + (node.code >> 4); i < end; ++i) {
            const uint place = ctx->bsp_list[i];
            if (!rt_was_tested(&tested, place)) RT_LEAF(ctx, place, ray, hit);
        }
        do {
            if (top == 0u) return;
            --top;
        } while (stack[top].from > hit->t);
        at = stack[top].node;
        from = stack[top].from;
        to = rt_min(stack[top].to, hit->t);
    }
}
