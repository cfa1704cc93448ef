/* grid2_types.h -- a grid of grids for each group. Shared by builder and traversal. */
#ifndef GRID2_TYPES_H
#define GRID2_TYPES_H
/* 64 B. Cell (x, y, z) of a grid is grid2_cells[first + i], where i = (z * cells[1] + y) * cells[0] + x. In a coarse grid that is the
 * number of the fine grid in that cell, or RT_NONE where there are no primitives. In a fine grid, the cell's
 * primitives are grid2_list[grid2_cells[first + i]] to grid2_list[grid2_cells[first + i + 1] - 1]. The list has positions in leaf order.
 * Behind the last cell of any grid there is one more, of primitives that are too large for cells. That of a coarse grid names a fine
 * grid without a box, of one empty cell and the one behind it. */
typedef struct grid2_grid {
    rt_f32 box[6];   /* lo.xyz, hi.xyz */
    rt_f32 size[3];  /* of a cell */
    rt_u32 cells[3]; /* along x, y, z */
    rt_u32 first;
    rt_u32 pad[3];
} grid2_grid;
#endif
