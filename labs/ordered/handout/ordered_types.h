/* ordered_types.h -- the nodes of the lab's tree, for builder and kernels. */
#ifndef ORDERED_TYPES_H
#define ORDERED_TYPES_H
/* The boxes of both children (lo.xyz, hi.xyz), and what they are: the number of a node, or a leaf. 64 bytes. */
typedef struct ordered_node {
    rt_f32 left_box[6], right_box[6];
    rt_u32 left, right;
    rt_u32 unused[2];
} ordered_node;
/* A leaf: bit 31, the number of its primitives in bits 28 to 30, the first of them in leaf order in the others. */
#define ORDERED_LEAF 0x80000000u
#define ORDERED_LEAF_MAX 4u
#define ORDERED_NONE 0xFFFFFFFFu
#endif
