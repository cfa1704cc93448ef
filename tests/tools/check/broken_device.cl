/* broken_device.cl -- a balanced tree over primitives in the order of a curve, each node by itself. */
typedef struct halves_node {
    float lo[3];
    uint left;
    float hi[3];
    uint right;
} halves_node;
#define HALVES_LEAF 0x80000000u

#define BOX 1u
#define LOSES 2u
#define COUNTS 3u
#define STATE 4u
#define GROUPS 5u
#define INPUT 6u

RT_BUILD_KERNEL count_runs(global uint *runs)
{
    if (RT_GROUP_NUMBER == 0u && RT_ITEM == 0u) ++*runs;
}

/* Node i splits places at i + 1, so each number occurs once. */
RT_BUILD_KERNEL halves_nodes(const global rt_block *blocks, uint count, uint each, global halves_node *nodes, global uint *counts,
                             global uint *root, uint defect, const global uint *runs, global rt_build_box *prims)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count - 1u);
    for (uint i = begin + RT_ITEM; i < end; i += defect == GROUPS ? 256u : RT_GROUP) {
        const uint split = i + 1u;
        uint first = 0u, last = count, middle = count / 2u;
        while (middle != split) {
            if (split < middle)
                last = middle;
            else
                first = middle;
            middle = first + (last - first) / 2u;
        }
        const rt_block box = rt_box_of_range(blocks, count, defect == BOX && last - first > 2u ? first + 1u : first, last);
        halves_node node;
        vstore3(box.lo.xyz, 0, node.lo);
        vstore3(box.hi.xyz, 0, node.hi);
        node.left = split - first == 1u ? HALVES_LEAF | first : first + (split - first) / 2u - 1u;
        node.right = last - split == 1u ? HALVES_LEAF | split : split + (last - split) / 2u - 1u;
        if (defect == LOSES && last - first == 2u) node.right = node.left;
        if (defect == STATE && *runs > 1u) {
            const uint left = node.left;
            node.left = node.right;
            node.right = left;
        }
        nodes[i] = node;
        counts[i] = last - first - (defect == COUNTS && i % 7u == 3u ? 1u : 0u);
        if (last - first == count) *root = i;
        if (defect == INPUT && i == 1u) prims[0].lo[0] -= 1.0f;
    }
}
