/* fit_nodes.h -- the kernel that refits nodes which hold the boxes of their children: RT_FIT_KERNEL.
 *
 * A file that includes it has included fit.h, and defines
 *   RT_FIT_KERNEL   the kernel's name
 *   RT_FIT_NODE     the type of what the nodes' buffer holds
 *   RT_FIT_WIDTH    the most children of a node: a power of two, up to 32
 *   RT_FIT_CHILD(fit, nodes, index, slot)   a function: writes the box of the child in a slot of node `index`, and returns its share of
 *                   the expected cost of a ray, times the area of the tree's box; 0 of an empty slot
 */

/* Fits the nodes first_node .. first_node + elements - 1. costs: see rt_device_build::refit. On a GPU neighbouring work-items share a
 * node: each fits one child. */
RT_BUILD_KERNEL RT_FIT_KERNEL(global RT_FIT_NODE *nodes, const global uint2 *ranges, const global rt_block *blocks, uint count,
                              uint first_node, uint elements, uint each, uint first_leaf, uint root, float node_cost,
                              float primitive_cost, global float *costs)
{
    const rt_fit fit = {ranges, blocks, count, first_leaf, node_cost, primitive_cost};
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, elements);
#if RT_GROUP == 1
    const uint at_once = 1u, mine = 0u, first_slot = 0u, slots = RT_FIT_WIDTH;
    float cost[RT_FIT_WIDTH];
#else
    local float of_group[RT_GROUP];
    const uint at_once = RT_GROUP / RT_FIT_WIDTH, mine = RT_ITEM / RT_FIT_WIDTH, first_slot = RT_ITEM % RT_FIT_WIDTH, slots = 1u;
    local float *const cost = of_group + RT_FIT_WIDTH * mine;
#endif
    for (uint next = begin; next < end; next += at_once) {
        const uint e = next + mine, index = first_node + e;
        const uint2 all = e < end ? ranges[index] : (uint2)(0u);
        for (uint s = first_slot; s < first_slot + slots; ++s) cost[s] = all.y == 0u ? 0.0f : RT_FIT_CHILD(&fit, nodes, index, s);
        RT_LOCAL_BARRIER();
        if (e < end && first_slot == 0u) {
            float sum = cost[0];
            for (uint s = 1u; s < RT_FIT_WIDTH; ++s) sum += cost[s];
            if (index == root) sum += node_cost * rt_block_area(rt_fit_box(&fit, all));
            costs[e] = sum;
        }
        RT_LOCAL_BARRIER();
    }
}
