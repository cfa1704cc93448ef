/* blocks.cl -- makes the blocks of blocks.h from boxes, and larger ones from smaller ones. */

/* The blocks of the nine smallest sizes, of boxes[order[i]], or of boxes[i] if there is no order. */
RT_BUILD_KERNEL make_blocks(const global rt_build_box *boxes, const global uint *order, uint has_order, uint count,
                            global rt_block *made, global rt_block *all, uint at, global float *bounds)
{
    local rt_block shared[RT_BLOCK_TILE];
    const uint first = RT_GROUP_NUMBER * RT_BLOCK_TILE;
    for (uint l = RT_ITEM; l < RT_BLOCK_TILE; l += RT_GROUP) {
        rt_block box = rt_no_block();
        if (first + l < count) {
            const global float *const prim = (const global float *)(boxes + (has_order ? order[first + l] : first + l));
            box.lo = vload4(0, prim);
            box.hi = vload4(1, prim);
            made[first + l] = box;
        }
        shared[l] = box;
    }
    RT_LOCAL_BARRIER();
    rt_make_blocks(shared, first, count, made, all + at, bounds);
}

/* The blocks of the eight sizes above one of which there are `blocks`, from made[begin] on. A single group makes all that are left. */
RT_BUILD_KERNEL make_larger_blocks(uint begin, uint blocks, global rt_block *made, global rt_block *all, uint at, global float *bounds)
{
    local rt_block shared[RT_BLOCK_TILE];
    const uint first = RT_GROUP_NUMBER * RT_BLOCK_TILE;
    made += begin;
    while (get_num_groups(0) == 1 && blocks > RT_BLOCK_TILE) {
        global rt_block *const above = made + blocks;
        const uint half_as_many = (blocks + 1u) / 2u;
        for (uint i = RT_ITEM; i < half_as_many; i += RT_GROUP)
            above[i] = 2u * i + 1u < blocks ? rt_join_blocks(made[2u * i], made[2u * i + 1u]) : made[2u * i];
        RT_GLOBAL_BARRIER();
        made = above;
        blocks = half_as_many;
    }
    for (uint l = RT_ITEM; l < RT_BLOCK_TILE; l += RT_GROUP)
        shared[l] = first + l < blocks ? made[first + l] : rt_no_block();
    RT_LOCAL_BARRIER();
    rt_make_blocks(shared, first, blocks, made, all + at, bounds);
}
