/* bvh4_build.cl -- merges the nodes of a binary tree on the device to nodes of up to four children, and refits such nodes.
 *
 * A node takes in the children of its largest child until it has four (Wald, Benthin, Boulos 2008). That goes from the root down,
 * and no work-group may wait for another. So it goes in three passes: one group descends to subtrees of at most 2^18 primitives,
 * then groups from there to subtrees of at most 2^9, then groups from there to the leaves. Within a group, level follows level. A
 * level of a pass holds subtrees that do not overlap, so it fits into local memory whatever the tree is. */
#include "cl/rt_shared.h"
#include "bvh4_types.h"

typedef struct bvh4_binary {
    float lo[3];
    uint left;
    float hi[3];
    uint right;
} bvh4_binary;

#define BVH4_SINGLE 0x80000000u /* a child of the binary tree that is one primitive: RT_TOPOLOGY_LEAF | its place in order */
#define BVH4_NONE 0xFFFFFFFFu
#define BVH4_LEVEL 1024u /* nodes of a level, at most */

/* Lists: [0] their length, then from [2] on pairs: binary node, first position in leaf order. */
RT_BUILD_KERNEL bvh4_begin(uint count, global uint *roots, global uint *middles, global uint *lows, global uint2 *children,
                           global uint *wide)
{
    if (RT_ITEM != 0u) return;
    roots[0] = count > 1u ? 1u : 0u;
    roots[2] = roots[3] = 0u;
    middles[0] = 0u;
    lows[0] = 0u;
    if (count < 2u) { /* no binary node: the root is written here */
        for (uint c = 0u; c < 4u; ++c) children[c] = (uint2)(BVH4_NONE, 0u);
        if (count == 1u) children[0] = (uint2)(BVH4_SINGLE, 0u);
        wide[0] = 1u;
    }
}

RT_INLINE float bvh4_area(const global bvh4_binary *node)
{
    const float x = node->hi[0] - node->lo[0], y = node->hi[1] - node->lo[1], z = node->hi[2] - node->lo[2];
    return x * y + y * z + z * x;
}
/* Whether a child is opened further: it has more primitives than a leaf holds. */
RT_INLINE bool bvh4_opens(const global uint *counts, uint child, uint max_leaf)
{
    return child < BVH4_SINGLE && counts[child] > max_leaf;
}
RT_INLINE uint bvh4_size(const global uint *counts, uint child) { return child < BVH4_SINGLE ? counts[child] : 1u; }

/* Descends from each subtree of the list `from` to those of at most `least` primitives, which it adds to the list `to`. The last
 * pass has `least` == max_leaf, and adds none. children: four for each binary node; wide: 1 for those that become wide nodes. */
RT_BUILD_KERNEL bvh4_open(const global bvh4_binary *nodes, const global uint *counts, uint max_leaf, uint least,
                          const global uint *from, global uint *to, global uint2 *children, global uint *wide)
{
    local uint2 level[2][BVH4_LEVEL];
    local uint size[2];
    const uint subtrees = from[0];
    for (uint s = RT_GROUP_NUMBER; s < subtrees; s += (uint)get_num_groups(0)) {
        if (RT_ITEM == 0u) {
            level[0][0] = vload2(1u + s, from);
            size[0] = 1u;
            size[1] = 0u;
        }
        RT_LOCAL_BARRIER();
        uint side = 0u;
        for (uint now = size[0]; now > 0u; now = size[side]) {
            for (uint i = RT_ITEM; i < now; i += RT_GROUP) {
                const uint2 at = level[side][i];
                uint child[4] = {nodes[at.x].left, nodes[at.x].right, BVH4_NONE, BVH4_NONE};
                uint number = 2u;
                for (; number < 4u; ++number) {
                    uint best = 4u;
                    float largest = -1.0f;
                    for (uint c = 0u; c < number; ++c)
                        if (bvh4_opens(counts, child[c], max_leaf)) {
                            const float area = bvh4_area(nodes + child[c]);
                            if (best == 4u || area > largest) best = c, largest = area;
                        }
                    if (best == 4u) break;
                    const uint opened = child[best];
                    for (uint c = number; c > best + 1u; --c) child[c] = child[c - 1u]; /* children stay in leaf order */
                    child[best] = nodes[opened].left;
                    child[best + 1u] = nodes[opened].right;
                }
                uint first = at.y;
                for (uint c = 0u; c < 4u; ++c) {
                    children[4u * at.x + c] = (uint2)(child[c], first);
                    if (c >= number) continue;
                    const uint below = bvh4_size(counts, child[c]);
                    if (bvh4_opens(counts, child[c], max_leaf)) {
                        if (below > least)
                            level[1u - side][atomic_inc(&size[1u - side])] = (uint2)(child[c], first);
                        else
                            vstore2((uint2)(child[c], first), 1u + atomic_inc(&to[0]), to);
                    }
                    first += below;
                }
                wide[at.x] = 1u;
            }
            RT_LOCAL_BARRIER();
            if (RT_ITEM == 0u) size[side] = 0u;
            RT_LOCAL_BARRIER();
            side = 1u - side;
        }
        RT_LOCAL_BARRIER(); /* before the level is used again */
    }
}

/* Writes the leaf order of a subtree of at most BVH4_LEAF_MAX primitives. */
RT_INLINE void bvh4_leaf(const global bvh4_binary *nodes, const global uint *order, uint child, global uint *leaves)
{
    uint stack[BVH4_LEAF_MAX + 1u], top = 0u;
    stack[top++] = child;
    while (top > 0u) {
        const uint at = stack[--top];
        if (at >= BVH4_SINGLE) {
            *leaves++ = order[at & ~BVH4_SINGLE];
        } else {
            stack[top++] = nodes[at].right;
            stack[top++] = nodes[at].left;
        }
    }
}

/* Writes the wide nodes, each at its number: at[b] is the sum of `wide` before binary node b. They begin at element first_node;
 * there are `elements` elements for them, and those that are left over become no nodes. */
RT_BUILD_KERNEL bvh4_write(const global rt_build_box *prims, const global bvh4_binary *nodes, const global uint *counts,
                           const global uint *order, uint count, uint binaries, uint elements, uint each, uint max_leaf,
                           const global uint2 *children, const global uint *at, uint first_node, uint first_leaf,
                           global float *to, global uint2 *ranges, global uint *leaves)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, max(binaries, elements)), used = at[binaries];
    for (uint b = begin + RT_ITEM; b < end; b += RT_GROUP) {
        if (b >= used && b < elements) ranges[first_node + b] = (uint2)(0u, 0u);
        if (b >= binaries || at[b] == at[b + 1u]) continue;
        float box[4][6], place[4][2], middle[2] = {0.0f, 0.0f};
        uint code[4], number = 0u;
        for (; number < 4u; ++number) {
            const uint2 child = children[4u * b + number];
            if (child.x == BVH4_NONE) break;
            for (uint a = 0u; a < 3u; ++a) {
                const bool single = child.x >= BVH4_SINGLE;
                const uint prim = single ? order[child.x & ~BVH4_SINGLE] : 0u;
                box[number][a] = single ? prims[prim].lo[a] : nodes[child.x].lo[a];
                box[number][3u + a] = single ? prims[prim].hi[a] : nodes[child.x].hi[a];
            }
            for (uint a = 0u; a < 2u; ++a) place[number][a] = 0.5f * box[number][a] + 0.5f * box[number][3u + a];
            if (bvh4_opens(counts, child.x, max_leaf)) {
                code[number] = BVH4_NODE_REF(first_node + at[child.x]);
            } else {
                code[number] = BVH4_MAKE_LEAF(first_leaf + child.y, bvh4_size(counts, child.x));
                bvh4_leaf(nodes, order, child.x, leaves + child.y);
            }
        }
        for (uint c = 0u; c < number; ++c)
            for (uint a = 0u; a < 2u; ++a) middle[a] += place[c][a] / (float)number;
        /* Slots as node_slots.cpp assigns them: bit 0 means the high side in x, bit 1 the high side in y. */
        uint child_of[4] = {4u, 4u, 4u, 4u}, placed = 0u;
        for (uint left = number; left > 0u; --left) {
            uint child = 4u, slot = 4u;
            float best = 0.0f;
            for (uint c = 0u; c < number; ++c)
                for (uint s = 0u; s < 4u; ++s) {
                    if (placed >> c & 1u || child_of[s] < 4u) continue;
                    const float x = place[c][0] - middle[0], y = place[c][1] - middle[1];
                    const float fit = (s & 1u ? x : -x) + (s & 2u ? y : -y);
                    if (child < 4u && !(fit > best)) continue;
                    best = fit;
                    child = c;
                    slot = s;
                }
            child_of[slot] = child;
            placed |= 1u << child;
        }
        const uint index = first_node + at[b];
        ranges[index] = number > 0u ? (uint2)(children[4u * b].y, count > 1u ? counts[b] : count) : (uint2)(0u, 0u);
        global float *const node = to + 32u * (ulong)index; /* its rows are permuted: bvh4_types.h */
        global uint *const codes = (global uint *)node;
        for (uint s = 0u; s < 4u; ++s) {
            const uint c = child_of[s];
            for (uint k = 0u; k < 6u; ++k)
                node[4u * (k ^ (index & 7u)) + s] = c < 4u ? box[c][k] : k < 3u ? INFINITY : -INFINITY;
            codes[4u * (6u ^ (index & 7u)) + s] = c < 4u ? code[c] : BVH4_EMPTY;
            codes[4u * (7u ^ (index & 7u)) + s] = 0u;
        }
    }
}

/* Fits the nodes first_node .. first_node + elements - 1 to the boxes of the primitives below them, which come from `blocks`. count:
 * of primitives. costs: see rt_device_build::refit. */
RT_BUILD_KERNEL bvh4_refit(global float *nodes, const global uint2 *ranges, const global rt_block *blocks, uint count,
                           uint first_node, uint elements, uint each, uint first_leaf, uint root, float node_cost,
                           float primitive_cost, global float *costs)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, elements);
    for (uint e = begin + RT_ITEM; e < end; e += RT_GROUP) {
        const uint index = first_node + e;
        if (ranges[index].y == 0u) {
            costs[e] = 0.0f;
            continue;
        }
        global float *const node = nodes + 32u * (ulong)index;
        const uint4 codes = vload4(6u ^ (index & 7u), (const global uint *)node);
        const uint code[4] = {codes.x, codes.y, codes.z, codes.w};
        float cost = 0.0f;
        rt_block child[4], whole = rt_no_block();
        for (uint s = 0u; s < 4u; ++s) {
            uint2 below = (uint2)(0u, 0u);
            const bool leaf = code[s] >= BVH4_LEAF;
            if (!leaf)
                below = ranges[BVH4_INDEX(code[s])];
            else if (code[s] != BVH4_EMPTY)
                below = (uint2)(BVH4_LEAF_FIRST(code[s]) - first_leaf, BVH4_LEAF_COUNT(code[s]));
            child[s] = rt_box_of_range(blocks, count, below.x, below.x + below.y);
            if (below.y > 0u) cost += rt_block_area(child[s]) * (leaf ? primitive_cost * (float)below.y : node_cost);
            whole = rt_join_blocks(whole, child[s]);
        }
        costs[e] = cost + (index == root ? node_cost * rt_block_area(whole) : 0.0f);
        const uint turn = index & 7u;
        vstore4((float4)(child[0].lo.x, child[1].lo.x, child[2].lo.x, child[3].lo.x), 0u ^ turn, node);
        vstore4((float4)(child[0].lo.y, child[1].lo.y, child[2].lo.y, child[3].lo.y), 1u ^ turn, node);
        vstore4((float4)(child[0].lo.z, child[1].lo.z, child[2].lo.z, child[3].lo.z), 2u ^ turn, node);
        vstore4((float4)(child[0].hi.x, child[1].hi.x, child[2].hi.x, child[3].hi.x), 3u ^ turn, node);
        vstore4((float4)(child[0].hi.y, child[1].hi.y, child[2].hi.y, child[3].hi.y), 4u ^ turn, node);
        vstore4((float4)(child[0].hi.z, child[1].hi.z, child[2].hi.z, child[3].hi.z), 5u ^ turn, node);
    }
}
