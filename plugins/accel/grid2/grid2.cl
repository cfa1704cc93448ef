/* grid2.cl -- one ray through the cells of a coarse grid, and through the fine grid of each (Kalojanov, Billeter, Slusallek 2011,
 * "Two-Level Grids for Ray Tracing on GPUs"). cl/lanes/cells.h serves both levels. No stack. */
#include "cl/lanes/cells.h"
#include "cl/lanes/mailbox.h"

RT_INLINE uint RT_CAT(RT_TRAVERSE, _cell)(const rt_ctx *ctx, const global grid2_grid *grid, const rt_cells *at)
{
    return grid->first + ((uint)at->z.at * grid->cells[1] + (uint)at->y.at) * grid->cells[0] + (uint)at->x.at;
}

RT_INLINE void RT_CAT(RT_TRAVERSE, _list)(const rt_ctx *ctx, uint cell, rt_mailbox *tested, const rt_single_ray *ray, rt_single_hit *hit)
{
    for (uint i = ctx->grid2_cells[cell], end = ctx->grid2_cells[cell + 1u]; i < end; ++i) {
        const uint at = ctx->grid2_list[i];
        if (!rt_was_tested(tested, at)) RT_LEAF(ctx, at, ray, hit);
#if RT_ANY_HIT
        if (hit->t < 0.0f) return;
#endif
    }
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    const global grid2_grid *coarse = RT_NODE(ray, ctx->grid2_grids + root);
    const uint huge = ctx->grid2_cells[coarse->first + coarse->cells[0] * coarse->cells[1] * coarse->cells[2]];
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    RT_COUNT_VISIT(hit, 1u); /* the coarse grid's box, and the list of what no cell holds */
    if (huge != RT_NONE) RT_CAT(RT_TRAVERSE, _list)(ctx, ctx->grid2_grids[huge].first + 1u, &tested, ray, hit);

    rt_cells outer, inner;
    bool more = rt_first_cell(&outer, coarse->box, coarse->size, coarse->cells, ray, hit);
    for (; more; more = rt_next_cell(&outer, hit->t)) {
        const uint number = ctx->grid2_cells[RT_CAT(RT_TRAVERSE, _cell)(ctx, coarse, &outer)];
        RT_COUNT_VISIT(hit, 1u);
        if (number == RT_NONE) continue;
        const global grid2_grid *fine = ctx->grid2_grids + number;
        bool within = rt_first_cell(&inner, fine->box, fine->size, fine->cells, ray, hit);
        for (; within; within = rt_next_cell(&inner, hit->t)) {
            RT_COUNT_VISIT(hit, 1u);
            RT_CAT(RT_TRAVERSE, _list)(ctx, RT_CAT(RT_TRAVERSE, _cell)(ctx, fine, &inner), &tested, ray, hit);
        }
    }
}
