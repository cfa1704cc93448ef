/* broken_build.cl -- refits the binary tree on the device. */
typedef struct broken_node { /* of broken_types.h */
    float box[6];
    uint first, count;
} broken_node;

#define FORGETS 1u
#define OUTSIDE 2u
#define NO_COSTS 3u
#define CONSTANT_COSTS 4u

RT_BUILD_KERNEL broken_refit(global broken_node *nodes, const global uint2 *ranges, const global rt_block *blocks, uint count,
                             uint first_node, uint elements, uint each, global float *costs, uint defect)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, elements);
    for (uint e = begin + RT_ITEM; e < end; e += RT_GROUP) {
        const uint at = first_node + e;
        const uint2 below = ranges[at];
        if (defect != NO_COSTS) costs[e] = 0.0f;
        if (below.y == 0u || (defect == FORGETS && at % 5u == 2u)) continue;
        const rt_block box = rt_box_of_range(blocks, count, below.x, below.x + below.y);
        vstore3(box.lo.xyz, 0, nodes[at].box);
        vstore3(box.hi.xyz, 0, nodes[at].box + 3);
        if (defect != NO_COSTS) costs[e] = rt_block_area(defect == CONSTANT_COSTS ? rt_box_of_range(blocks, count, 0u, count) : box);
    }
    if (defect == OUTSIDE && first_node > 0u && RT_GROUP_NUMBER == 0u && RT_ITEM == 0u) nodes[first_node - 1u].box[0] -= 1.0f;
}
