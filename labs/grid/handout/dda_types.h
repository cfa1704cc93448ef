/* dda_types.h -- the lab's grid, for builder and kernels. */
#ifndef DDA_TYPES_H
#define DDA_TYPES_H
/* The primitives of cell (x, y, z) are dda_list[s[cell]] to dda_list[s[cell + 1] - 1], in leaf order, where s = dda_starts + first and
 * cell = (z * cells[1] + y) * cells[0] + x. 64 bytes. */
typedef struct dda_grid {
    rt_f32 box[6];   /* lo.xyz, hi.xyz */
    rt_f32 size[3];  /* of a cell */
    rt_u32 cells[3]; /* along x, y, z */
    rt_u32 first;
    rt_u32 unused[3];
} dda_grid;
#endif
