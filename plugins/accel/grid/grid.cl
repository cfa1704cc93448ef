/* grid.cl -- one ray from cell to cell (Amanatides, Woo 1987; cl/lanes/cells.h), and through the list of each; a packet whose rays stay
 * together from slice to slice (cl/lanes/slices.h). No stack.
 *
 * A primitive stands in the list of each cell that it meets. The mailbox keeps a ray from testing it in all of them. */
#include "cl/lanes/cells.h"
#include "cl/lanes/mailbox.h"
#include "cl/lanes/slices.h"

RT_INLINE void RT_CAT(RT_TRAVERSE, _list)(const rt_ctx *ctx, const global uint *start, rt_mailbox *tested, const rt_single_ray *ray,
                                          rt_single_hit *hit)
{
    for (uint i = start[0]; i < start[1]; ++i) {
        const uint at = ctx->grid_list[i];
        if (!rt_was_tested(tested, at)) RT_LEAF(ctx, at, ray, hit);
#if RT_ANY_HIT
        if (hit->t < 0.0f) return;
#endif
    }
}

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    const global grid_head *grid = RT_NODE(ray, ctx->grid_heads + root);
    const global uint *starts = ctx->grid_starts + grid->first;
    const uint nx = grid->cells[0], ny = grid->cells[1], nz = grid->cells[2];
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    RT_COUNT_VISIT(hit, 1u); /* the grid's box, and the list of what no cell holds */
    RT_CAT(RT_TRAVERSE, _list)(ctx, starts + nx * ny * nz, &tested, ray, hit);

    rt_cells cells;
    for (bool more = rt_first_cell(&cells, grid->box, grid->size, grid->cells, ray, hit); more; more = rt_next_cell(&cells, hit->t)) {
        RT_COUNT_VISIT(hit, 1u);
        const uint cell = ((uint)cells.z.at * ny + (uint)cells.y.at) * nx + (uint)cells.x.at;
        RT_CAT(RT_TRAVERSE, _list)(ctx, starts + cell, &tested, ray, hit);
    }
}

#if RT_LANES > 1
bool RT_CAT(RT_TRAVERSE, _packet)(const rt_ctx *ctx, uint root, const rt_rays *ray, rt_hits *hit)
{
    const global grid_head *grid = ctx->grid_heads + root;
    const global uint *starts = ctx->grid_starts + grid->first;
    rt_slices s;
    if (!rt_begin_slices(&s, grid->box, grid->size, grid->cells, ray, hit)) return false;
    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    const global uint *start = RT_NODE(ray, starts + grid->cells[0] * grid->cells[1] * grid->cells[2]);
    RT_COUNT_STEP(hit);
    for (uint i = start[0]; i < start[1]; ++i) RT_PACKET_LEAF(ctx, ctx->grid_list[i], ray, hit);
    while (rt_next_slice(&s, ctx->grid_blocks + grid->first_block, hit))
        for (int v = s.first_v; v <= s.last_v; ++v)
            for (int u = s.first_u; u <= s.last_u; ++u) {
                start = RT_NODE(ray, starts + rt_slice_cell(&s, u, v));
                RT_COUNT_VISIT(hit, rt_bits(s.active));
                for (uint i = start[0]; i < start[1]; ++i) {
                    const uint at = ctx->grid_list[i];
                    if (!rt_was_tested(&tested, at)) RT_PACKET_LEAF(ctx, at, ray, hit);
                }
#if RT_ANY_HIT
                if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return true;
#endif
            }
    return true;
}
#endif
