/* wide_types.h -- the lab's nodes, for builder and kernels. */
#ifndef WIDE_TYPES_H
#define WIDE_TYPES_H
/* A node of up to four children, in 64 bytes. What `frame`, `lo` and `hi` mean is decided by wide_pack.hpp, which writes them, and
 * wide_unpack.h, which reads them. */
typedef struct wide_node {
    rt_f32 frame[6];
    unsigned char lo[4][3], hi[4][3]; /* of each child, for x, y, z */
    rt_u32 child[4];                  /* a node, or a leaf, or WIDE_NONE; those that are none come last */
} wide_node;
/* A leaf: bit 31, the number of its primitives in bits 28 to 30, the first of them in leaf order in the others. */
#define WIDE_LEAF 0x80000000u
#define WIDE_NONE 0xFFFFFFFFu
/* Three children wait at each level, and median splits have at most 28 levels of two. */
#define WIDE_STACK 96u
#endif
