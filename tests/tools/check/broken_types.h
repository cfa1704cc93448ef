/* broken_types.h -- the node of a small binary BVH, which is right until a defect is chosen: see broken.cpp. */
#ifndef BROKEN_TYPES_H
#define BROKEN_TYPES_H
/* 32 B. An inner node (count 0) has its children at first and first + 1, a leaf its primitives. */
typedef struct broken_node {
    rt_f32 box[6]; /* lo.xyz, hi.xyz */
    rt_u32 first, count;
} broken_node;
#define BROKEN_EMPTY 0xFFFFFFFFu /* count of a leaf without primitives */
#endif
