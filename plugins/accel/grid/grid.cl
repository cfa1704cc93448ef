/* grid.cl -- one ray from cell to cell (Amanatides, Woo 1987; cl/lanes/cells.h), and through the list of each; a packet whose rays stay
 * together from slice to slice (cl/lanes/slices.h). No stack.
 *
 * A primitive stands in the list of each cell that it meets, and the mailbox keeps a ray from testing it in all of them. On a CPU RT_LANES boxes of a
 * list are compared at once with the ray or the packet (cl/lanes/cell_parts.h): few triangles are left. On a GPU, where one comparison
 * saves one test at most, that costs more than it saves (docs/which_structure.md). */
#include "cl/lanes/cells.h"
#include "cl/lanes/cell_parts.h"
#include "cl/lanes/mailbox.h"
#include "cl/lanes/slices.h"

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    const global grid_head *grid = RT_NODE(ray, ctx->grid_heads + root);
    const global uint *starts = ctx->grid_starts + grid->first;
    const uint nx = grid->cells[0], ny = grid->cells[1], nz = grid->cells[2];
    RT_COUNT_VISIT(hit, 1u); /* the grid's box, and the list of what no cell holds */
    const global uint *start = starts + nx * ny * nz;
    for (uint i = start[0]; i < start[1]; ++i) RT_LEAF(ctx, ctx->grid_list[i], ray, hit);

    rt_mailbox tested;
    rt_clear_mailbox(&tested);
    rt_cells cells;
#if RT_CPU
    rt_part_ray part_ray;
    rt_begin_part_ray(&part_ray, grid->size, ray);
#endif
    for (bool more = rt_first_cell(&cells, grid->box, grid->size, grid->cells, ray, hit); more; more = rt_next_cell(&cells, hit->t)) {
        RT_COUNT_VISIT(hit, 1u);
        start = starts + ((uint)cells.z.at * ny + (uint)cells.y.at) * nx + (uint)cells.x.at;
#if RT_CPU
        for (uint i = start[0]; i < start[1]; i += RT_LANES) {
            RT_COUNT_BOXES(hit, min(start[1] - i, (uint)RT_LANES));
            for (uint bits = rt_ray_meets(&part_ray, &cells, ray, hit, ctx->grid_parts + i, start[1] - i); bits != 0u; bits &= bits - 1u) {
                const uint at = ctx->grid_list[i + rt_lowest(bits)];
                if (!rt_was_tested(&tested, at)) RT_LEAF(ctx, at, ray, hit);
            }
            if (RT_ANY_HIT && hit->t < 0.0f) return;
        }
#else
        for (uint i = start[0]; i < start[1]; ++i) {
            const uint at = ctx->grid_list[i];
            if (!rt_was_tested(&tested, at)) RT_LEAF(ctx, at, ray, hit);
            if (RT_ANY_HIT && hit->t < 0.0f) return;
        }
#endif
    }
}

#if RT_LANES > 1
/* How many primitives a packet collects, at least, before it tests them. So several are fetched at once: a test ends with a branch that the
 * processor cannot predict. */
#define GRID_FOUND 16u
#if RT_CPU && RT_HAS_BUILTIN(__builtin_prefetch) && !defined(__SPIR__) /* simulators compile for SPIR */
#define GRID_PREFETCH(place) __builtin_prefetch((const void *)(ulong)(place))
#else
#define GRID_PREFETCH(place)
#endif
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
    const global ulong *blocks = ctx->grid_blocks + grid->first_block;
    uint found[GRID_FOUND + RT_LANES], count = 0u;
    while (rt_next_slice(&s, blocks, hit)) {
        for (int v = s.first_v; v <= s.last_v; ++v)
            for (int u = s.first_u; u <= s.last_u; ++u) {
                if (!rt_slice_has(&s, blocks, u, v)) continue;
                start = RT_NODE(ray, starts + rt_slice_cell(&s, u, v));
                RT_COUNT_VISIT(hit, rt_bits(s.active));
                for (uint i = start[0]; i < start[1]; i += RT_LANES) {
                    GRID_PREFETCH(ctx->grid_list + i);
                    RT_COUNT_BOXES(hit, min(start[1] - i, (uint)RT_LANES));
                    for (uint bits = rt_slice_meets(&s, u, v, ctx->grid_parts + i, start[1] - i); bits != 0u; bits &= bits - 1u) {
                        const uint at = ctx->grid_list[i + rt_lowest(bits)];
                        found[count] = at;
                        GRID_PREFETCH(ctx->leaves + at);
                        count += rt_was_tested(&tested, at) ? 0u : 1u;
                    }
                    if (count >= GRID_FOUND) {
                        for (uint k = 0; k < count; ++k) RT_PACKET_LEAF(ctx, found[k], ray, hit);
                        count = 0u;
                    }
                }
            }
        for (uint k = 0; k < count; ++k) RT_PACKET_LEAF(ctx, found[k], ray, hit);
        count = 0u;
#if RT_ANY_HIT
        if (!rt_any(RT_MASK(hit->t >= rt_vfloat(0.0f)))) return true;
#endif
    }
    return true;
}
#endif
