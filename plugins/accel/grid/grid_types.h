/* grid_types.h -- a uniform grid for each group. Shared by builder and traversal. */
#ifndef GRID_TYPES_H
#define GRID_TYPES_H
#define RT_TRAVERSES_PACKETS /* see "Single rays" in CONTRACT.md */
/* 64 B. The primitives of cell (x, y, z) are grid_list[s[cell]] to grid_list[s[cell + 1] - 1], where s = grid_starts + first and
 * cell = (z * cells[1] + y) * cells[0] + x. The list has positions in leaf order. Behind the last cell there is one more, of
 * primitives that are too large for a grid. grid_parts says where in the cell each one's box is (cl/lanes/cell_parts.h). A block is
 * 4 x 4 x 4 cells, those at the upper sides less; grid_blocks + first_block has the blocks in the same order, and bit x + 4 y + 16 z of
 * each is 1 if its cell (x, y, z) has a primitive. */
typedef struct grid_head {
    rt_f32 box[6];   /* lo.xyz, hi.xyz */
    rt_f32 size[3];  /* of a cell */
    rt_u32 cells[3]; /* along x, y, z */
    rt_u32 first, first_block;
    rt_u32 pad[2];
} grid_head;
#endif
