/* lbvh_build.cl -- a binary tree over primitives in the order of a Morton curve, each node by itself (Karras 2012, "Maximizing
 * Parallelism in the Construction of BVHs, Octrees, and k-d Trees").
 *
 * Karras finds the boxes from the leaves up, where the second of two children to arrive goes on. That needs one work-group to see what
 * another has written during the same launch, which OpenCL 1.2 does not promise. Here they come from the host's blocks of neighbouring
 * primitives: cl/build/blocks.h. */
typedef struct lbvh_node {
    float lo[3];
    uint left;
    float hi[3];
    uint right;
} lbvh_node;
#define LBVH_LEAF 0x80000000u

/* The number of leading bits that the keys of i and j have in common; equal keys are told apart by i and j. */
RT_INLINE int lbvh_common(const global ulong *keys, uint count, ulong key, uint i, int j)
{
    const ulong differ = key ^ keys[clamp(j, 0, (int)count - 1)]; /* no branch: several of them wait for memory together */
    const int common = differ ? (int)clz(differ) : 64 + (int)clz(i ^ (uint)j);
    return j < 0 || j >= (int)count ? -1 : common;
}
/* Two steps of a binary search at once. Returns the greatest k of {0, first, second, first + second} for which the key at place
 * i + (from + k) * d has more than `least` leading bits in common with the key at place i. The three keys are fetched together, because
 * near the root a node would wait for one fetch after the other. */
RT_INLINE int lbvh_two_steps(const global ulong *keys, uint count, ulong key, uint i, int d, int from, int first, int second, int least)
{
    const int low = lbvh_common(keys, count, key, i, (int)i + (from + second) * d),
              middle = lbvh_common(keys, count, key, i, (int)i + (from + first) * d),
              high = lbvh_common(keys, count, key, i, (int)i + (from + first + second) * d);
    return middle > least ? first + (high > least ? second : 0) : low > least ? second : 0;
}

/* All inner nodes. Node i has a range of places that begins or ends at place i (Karras 2012, figure 4). */
RT_BUILD_KERNEL lbvh_nodes(const global ulong *keys, const global rt_block *blocks, uint count, uint each, global lbvh_node *nodes,
                           global uint *counts)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count - 1u);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        const ulong key = keys[i];
        const int up = lbvh_common(keys, count, key, i, (int)i + 1), down = lbvh_common(keys, count, key, i, (int)i - 1);
        const int d = up > down ? 1 : -1, least = min(up, down);
        int most = 2;
        while (lbvh_common(keys, count, key, i, (int)i + most * d) > least) most *= 4;
        int length = 0;
        for (int step = most / 2; step > 0; step /= 4) length += lbvh_two_steps(keys, count, key, i, d, length, step, step / 2, least);
        const int other = (int)i + length * d, common = lbvh_common(keys, count, key, i, other);
        int split = 0;
        for (int step = length; step > 1;) {
            const int first = (step + 1) / 2, second = first > 1 ? (first + 1) / 2 : 0;
            split += lbvh_two_steps(keys, count, key, i, d, split, first, second, common);
            step = second;
        }
        const uint middle = (uint)((int)i + split * d + min(d, 0));
        const uint first = min(i, (uint)other), last = max(i, (uint)other);
        const rt_block box = rt_box_of_range(blocks, count, first, last + 1u);
        lbvh_node node;
        vstore3(box.lo.xyz, 0, node.lo);
        vstore3(box.hi.xyz, 0, node.hi);
        node.left = first == middle ? LBVH_LEAF | middle : middle;
        node.right = last == middle + 1u ? LBVH_LEAF | last : middle + 1u;
        nodes[i] = node;
        counts[i] = last - first + 1u;
    }
}
