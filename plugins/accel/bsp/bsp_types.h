/* bsp_types.h -- a tree of planes in few directions for each group. Shared by builder and traversal.
 *
 * Kammaje, Mora 2007, "A Study of Restricted BSP Trees for Ray Tracing". */
#ifndef BSP_TYPES_H
#define BSP_TYPES_H
/* The tree of a group: the box of all its primitives, and its root. 32 B. */
typedef struct bsp_head {
    rt_f32 box[6]; /* lo.xyz, hi.xyz */
    rt_u32 node, pad;
} bsp_head;
/* 8 B. Bits 0 to 3 of `code` are the direction of the plane: the points p with n . p = split, for the n of BSP_COMPONENT. The others are
 * the index of the child below it, and the child above is the next node. Of a leaf they are 15, and the others are the number of its
 * primitives; then `first` is the place of their positions in bsp_list. */
typedef struct bsp_node {
    union {
        rt_f32 split;
        rt_u32 first;
    } at;
    rt_u32 code;
} bsp_node;
#define BSP_LEAF 15u
/* The 13 axes of a cube's symmetry: its three axes, its four diagonals, and the six of its faces. Components are -1, 0 or 1, so n . p has no
 * product that rounds. Two bits for each direction k: the component plus 1. */
#define BSP_DIRECTIONS 13u
#define BSP_XS 0x16AAA96u
#define BSP_YS 0x2948299u
#define BSP_ZS 0x8948A5u
#define BSP_COMPONENT(of, k) ((float)((int)((of) >> 2u * (k)&3u) - 1))
#endif
