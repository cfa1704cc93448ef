/* dda.cl -- traces one ray through a grid. Which cell comes next is decided by your two functions in dda_walk.h. */
#ifndef DDA_WALK_TYPE
#define DDA_WALK_TYPE

/* A ray in the grid, in units of cells: cell (x, y, z) reaches from x to x + 1, from y to y + 1 and from z to z + 1. Distances are along
 * the ray, from the point where it enters the grid: at distance t it is at point + t * direction. */
typedef struct dda_walk {
    float point[3], direction[3]; /* a direction may have zeros */
    int cells[3];                 /* how many there are along x, y, z */
    int cell[3];                  /* to be set by you: the cell that is visited */
    /* For you. They keep what you write there from one call to the next. */
    float next[3], delta[3];
    int step[3];
} dda_walk;

#include "dda_walk.h"

#endif

void RT_TRAVERSE(const rt_ctx *ctx, uint root, const rt_single_ray *ray, rt_single_hit *hit)
{
    const global dda_grid *grid = RT_NODE(ray, ctx->dda_grids + root);
    float enter, leave;
    if (!rt_enter_exit(grid->box, ray, hit, &enter, &leave)) return;
    const float origin[3] = {ray->ox, ray->oy, ray->oz}, direction[3] = {ray->dx, ray->dy, ray->dz};
    dda_walk walk;
    for (int k = 0; k < 3; ++k) {
        walk.cells[k] = (int)grid->cells[k];
        walk.point[k] = clamp((fma(direction[k], enter, origin[k]) - grid->box[k]) / grid->size[k], 0.0f, (float)walk.cells[k]);
        walk.direction[k] = direction[k] / grid->size[k];
        walk.cell[k] = 0;
    }
    const int nx = walk.cells[0], ny = walk.cells[1], nz = walk.cells[2];
    int more = dda_first(&walk);
    /* No walk visits more cells than there are. */
    for (int visits = 0; more && visits < nx * ny * nz; ++visits) {
        const int x = walk.cell[0], y = walk.cell[1], z = walk.cell[2];
        if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) return;
        const global uint *start = RT_NODE(ray, ctx->dda_starts + grid->first + (z * ny + y) * nx + x);
        for (uint i = start[0]; i < start[1]; ++i) {
            RT_LEAF(ctx, ctx->dda_list[i], ray, hit);
#if RT_ANY_HIT
            if (hit->t < 0.0f) return;
#endif
        }
        more = dda_next(&walk, hit->t - enter);
    }
}
