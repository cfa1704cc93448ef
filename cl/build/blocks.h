/* blocks.h -- the boxes of aligned blocks of 1, 2, 4, 8, ... neighbouring primitives, and from them that of any primitives which
 * stand side by side.
 *
 * A subtree's primitives are neighbours in leaf order. So the box of each node is that of few blocks, two of each size at most, and
 * all nodes can be fitted at the same time: no work-group waits for the nodes below. The blocks of all sizes stand one after the
 * other, the smallest first: n, then (n + 1) / 2, and so on down to one. */
#ifndef RT_BLOCKS_H
#define RT_BLOCKS_H

/* 24 B. */
typedef struct rt_block {
    float lo[3], hi[3];
} rt_block;
/* A box as rt_prim has it: 32 B. */
typedef struct rt_build_box {
    float lo[3];
    uint ref;
    float hi[3];
    uint mesh;
} rt_build_box;

RT_INLINE rt_block rt_no_block(void)
{
    rt_block b;
    for (uint a = 0u; a < 3u; ++a) b.lo[a] = INFINITY, b.hi[a] = -INFINITY;
    return b;
}
RT_INLINE rt_block rt_join_blocks(rt_block a, rt_block b)
{
    for (uint k = 0u; k < 3u; ++k) a.lo[k] = min(a.lo[k], b.lo[k]), a.hi[k] = max(a.hi[k], b.hi[k]);
    return a;
}
/* Half the surface of a box that is not empty. */
RT_INLINE float rt_block_area(rt_block b)
{
    const float x = b.hi[0] - b.lo[0], y = b.hi[1] - b.lo[1], z = b.hi[2] - b.lo[2];
    return x * y + y * z + z * x;
}
/* The box of the primitives first .. end - 1 of `count`. */
RT_INLINE rt_block rt_box_of_range(const global rt_block *blocks, uint count, uint first, uint end)
{
    rt_block box = rt_no_block();
    uint at = 0u, size = count, a = first, b = end;
    for (; a < b; a /= 2u, b /= 2u) {
        if (a & 1u) box = rt_join_blocks(box, blocks[at + a++]);
        if (b & 1u) box = rt_join_blocks(box, blocks[at + --b]);
        at += size;
        size = (size + 1u) / 2u;
    }
    return box;
}
#endif
