/* octree_types.h -- an octree for each group. Shared by builder and traversal. */
#ifndef OCTREE_TYPES_H
#define OCTREE_TYPES_H
/* The tree of a group: the box of all its primitives, and its root. 32 B. */
typedef struct octree_head {
    rt_f32 box[6]; /* lo.xyz, hi.xyz */
    rt_u32 node, pad;
} octree_head;
/* 16 B. Three planes through the centre part an inner node. `code` is the index of its first child; child i is above the planes whose
 * bits, 0 to 2 for x to z, are set in i. Of a leaf `code` has OCTREE_LEAF and the number of its primitives, and `first` is the place of
 * their positions in octree_list. */
typedef struct octree_node {
    union {
        rt_f32 center[3];
        rt_u32 first;
    } at;
    rt_u32 code;
} octree_node;
#define OCTREE_LEAF 0x80000000u
#endif
