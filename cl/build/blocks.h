/* blocks.h -- the boxes of aligned blocks of 1, 2, 4, 8, ... neighbouring primitives, and from them that of any primitives which
 * stand side by side.
 *
 * A subtree's primitives are neighbours in leaf order. So the box of each node is that of few blocks, two of each size at most, and
 * all nodes can be fitted at the same time: no work-group waits for the nodes below. The blocks of all sizes stand one after the
 * other, the smallest first: n, then (n + 1) / 2, and so on down to one. */
#ifndef RT_BLOCKS_H
#define RT_BLOCKS_H

/* 32 B, the least that a GPU reads at a time. x, y, z; w is unused. */
typedef struct rt_block {
    float4 lo, hi;
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
    b.lo = (float4)(INFINITY);
    b.hi = (float4)(-INFINITY);
    return b;
}
RT_INLINE rt_block rt_join_blocks(rt_block a, rt_block b)
{
    a.lo = min(a.lo, b.lo);
    a.hi = max(a.hi, b.hi);
    return a;
}
/* Half the surface of a box that is not empty. */
RT_INLINE float rt_block_area(rt_block b)
{
    const float4 size = b.hi - b.lo;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}
/* The box of the primitives first .. end - 1 of `count`. */
RT_INLINE rt_block rt_box_of_range(const global rt_block *blocks, uint count, uint first, uint end)
{
    rt_block box = rt_no_block();
    uint size = count, a = first, b = end;
    for (; a < b; a /= 2u, b /= 2u) {
        if (a & 1u) box = rt_join_blocks(box, blocks[a++]);
        if (b & 1u) box = rt_join_blocks(box, blocks[--b]);
        blocks += size;
        size = (size + 1u) / 2u;
    }
    return box;
}

/* Blocks that one work-group makes at a time, from as many of a smaller size. */
#define RT_BLOCK_TILE 256u
#define RT_BLOCK_SIZES 8u /* sizes above that */
/* Writes the blocks of the 8 sizes above the RT_BLOCK_TILE blocks in `shared`, which are those from first on of `blocks` many. They
 * stand from blocks[0] on in `made`. All work-items of the group call it together, after a barrier. If there is one block in the end,
 * it is written to *all, and its six numbers to `bounds`. */
RT_INLINE void rt_make_blocks(local rt_block *shared, uint first, uint blocks, global rt_block *made, global rt_block *all,
                              global float *bounds)
{
    for (uint pairs = RT_BLOCK_TILE / 2u; pairs > 0u && blocks > 1u; pairs /= 2u) {
        made += blocks;
        blocks = (blocks + 1u) / 2u;
        first /= 2u;
        rt_block box = rt_no_block();
#if RT_GROUP >= 128
        if (RT_ITEM < pairs) box = rt_join_blocks(shared[2u * RT_ITEM], shared[2u * RT_ITEM + 1u]);
        RT_LOCAL_BARRIER();
        if (RT_ITEM < pairs) {
            shared[RT_ITEM] = box;
            if (first + RT_ITEM < blocks) made[first + RT_ITEM] = box;
        }
        RT_LOCAL_BARRIER();
#else /* one work-item: RT_GROUP is 1 or 256 */
        for (uint i = 0u; i < pairs; ++i) {
            box = rt_join_blocks(shared[2u * i], shared[2u * i + 1u]);
            shared[i] = box;
            if (first + i < blocks) made[first + i] = box;
        }
#endif
    }
    if (blocks == 1u && RT_ITEM == 0u) {
        *all = shared[0];
        bounds[0] = shared[0].lo.x, bounds[1] = shared[0].lo.y, bounds[2] = shared[0].lo.z;
        bounds[3] = shared[0].hi.x, bounds[4] = shared[0].hi.y, bounds[5] = shared[0].hi.z;
    }
}
#endif
