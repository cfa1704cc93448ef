/* bsp.cl -- one ray through a tree of planes, nearest cells first, as kdtree.cl goes through a kd-tree.
 *
 * At t the ray is n . (o + t d) - split above a plane, give or take what rounding makes of a place: 16 RT_EPS of |o|, 32 RT_EPS of |t d|
 * and 4 RT_FAR_SLACK ("Slack" of CONTRACT.md has 8 and 16 for tests of primitives; here the builder rounds clipped corners, too). Both
 * bounds of that are linear in t, so each child has a span of its own, and the two overlap. Where a ray runs along a plane the spans are as
 * long as the node's: that is why a distance from the plane is bounded here, and not the t at which the ray meets it. */
#include "cl/lanes/mailbox.h"
#include "cl/lanes/span_stack.h"

/* Cuts a span to where a + t b <= 0. */
RT_INLINE void RT_CAT(RT_TRAVERSE, _cut)(float a, float b, rt_span *span)
{
    const float t = -a / b;
    if (b > 0.0f)
        span->to = rt_min(span->to, t * RT_WIDE);
    else if (b < 0.0f)
        span->from = rt_max(span->from, t * (2.0f - RT_WIDE));
    else if (a > 0.0f)
        span->to = -1.0f;
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    rt_span stack[BSP_STACK], now;
    const global bsp_head *head = RT_NODE(ray, ctx->bsp_heads + root);
    uint top = 0u;
    now.node = head->node;
    RT_COUNT_VISIT(hit, 1u); /* the tree's box */
    if (!rt_enter_exit(head->box, ray, hit, &now.from, &now.to)) return;
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    for (;;) {
        const bsp_node node = *RT_NODE(ray, ctx->bsp_nodes + now.node);
        const uint k = node.code & BSP_LEAF;
        RT_COUNT_VISIT(hit, 1u);
        if (k != BSP_LEAF) {
            const float x = BSP_COMPONENT(BSP_XS, k), y = BSP_COMPONENT(BSP_YS, k), z = BSP_COMPONENT(BSP_ZS, k);
            const float height = fma(x, ray->ox, fma(y, ray->oy, z * ray->oz)) - node.at.split, rise = fma(x, ray->dx, fma(y, ray->dy, z * ray->dz));
            const float slack = fma(fabs(x * ray->ox) + fabs(y * ray->oy) + fabs(z * ray->oz), 16.0f * RT_EPS, 4.0f * RT_FAR_SLACK);
            const float rising_slack = (fabs(x * ray->dx) + fabs(y * ray->dy) + fabs(z * ray->dz)) * (32.0f * RT_EPS);
            rt_span below = now, above = now;
            below.node = node.code >> 4;
            above.node = below.node + 1u;
            RT_CAT(RT_TRAVERSE, _cut)(height - slack, rise - rising_slack, &below);
            RT_CAT(RT_TRAVERSE, _cut)(-height - slack, -rise - rising_slack, &above);
            if (above.from > above.to) {
                now = below;
            } else if (below.from > below.to) {
                now = above;
            } else {
                const bool rises = rise > 0.0f;
                stack[top] = rises ? above : below;
                if (RT_STACK_OK(top + 1u, BSP_STACK, hit)) ++top;
                now = rises ? below : above;
            }
            continue;
        }
        for (uint i = node.at.first, end = i + (node.code >> 4); i < end; ++i) {
            const uint place = ctx->bsp_list[i];
            if (!rt_was_tested(&tested, place)) RT_LEAF(ctx, place, ray, hit);
        }
        if (!rt_pop_span(stack, &top, hit->t, &now)) return;
    }
}
