/* blocks.cl -- makes the blocks of blocks.h, in passes of eight sizes each. */

/* Makes the blocks of the 8 sizes above `size` (a power of two, as its logarithm), 256 blocks of that size for each work-group. From
 * `begin` on stand the blocks of this size, `blocks` many. For size 0 they are made here, too, from boxes[order[i]], or from boxes[i]
 * if there is no order. */
RT_BUILD_KERNEL make_blocks(const global rt_build_box *boxes, const global uint *order, uint has_order, uint size, uint begin,
                            uint blocks, global rt_block *made)
{
    local rt_block shared[2][256];
    const uint first = RT_GROUP_NUMBER * 256u;
    for (uint l = RT_ITEM; l < 256u; l += RT_GROUP) {
        rt_block box = rt_no_block();
        if (first + l < blocks) {
            if (size > 0u) {
                box = made[begin + first + l];
            } else {
                const rt_build_box prim = boxes[has_order ? order[first + l] : first + l];
                for (uint a = 0u; a < 3u; ++a) box.lo[a] = prim.lo[a], box.hi[a] = prim.hi[a];
                made[begin + first + l] = box;
            }
        }
        shared[0][l] = box;
    }
    RT_LOCAL_BARRIER();
    uint from = 0u;
    for (uint pairs = 128u; pairs > 0u && blocks > 1u; pairs /= 2u) {
        begin += blocks;
        blocks = (blocks + 1u) / 2u;
        for (uint l = RT_ITEM; l < pairs; l += RT_GROUP) {
            const rt_block box = rt_join_blocks(shared[from][2u * l], shared[from][2u * l + 1u]);
            shared[1u - from][l] = box;
            const uint at = RT_GROUP_NUMBER * pairs + l;
            if (at < blocks) made[begin + at] = box;
        }
        RT_LOCAL_BARRIER();
        from = 1u - from;
    }
}
