/* kdtree_types.h -- a kd-tree for each group. Shared by builder and traversal. */
#ifndef KDTREE_TYPES_H
#define KDTREE_TYPES_H
#define RT_TRAVERSES_PACKETS /* see "Single rays" in CONTRACT.md */
/* The tree of a group: the box of all its primitives, and its root. 32 B. */
typedef struct kdtree_head {
    rt_f32 box[6]; /* lo.xyz, hi.xyz */
    rt_u32 node, pad;
} kdtree_head;
/* 8 B. Bits 0 and 1 of `code` are the axis of the plane, at `split`; the others are the index of the child below it, and the child above
 * is the next node. Of a leaf they are 3, and the others are the number of its primitives; then `first` is the place of their
 * positions in kdtree_list. */
typedef struct kdtree_node {
    union {
        rt_f32 split;
        rt_u32 first;
    } at;
    rt_u32 code;
} kdtree_node;
#define KDTREE_LEAF 3u
#endif
