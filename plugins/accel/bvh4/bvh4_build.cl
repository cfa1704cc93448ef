/* bvh4_build.cl -- merges the nodes of a binary tree on the device to nodes of up to four children, and refits such nodes.
 *
 * A node takes in the children of its largest child until it has four (Wald, Benthin, Boulos 2008). That goes from the root down,
 * and no work-group may wait for another. So it goes in passes: groups descend from few large subtrees to many smaller ones, level
 * by level, each pass to subtrees 512 times smaller (device_build.cpp), and in the end each work-item has small subtrees to itself.
 * Within a pass a level holds subtrees that do not overlap, so it fits into local memory whatever the tree is. The nodes of a round
 * are taken together from one counter: their order differs from run to run, the tree does not. */
#include "cl/build/fit.h"
#include "cl/rt_shared.h"
#include "bvh4_types.h"

#define BVH4_SINGLE 0x80000000u /* a child of the binary tree that is one primitive: RT_TOPOLOGY_LEAF | its place in order */
#define BVH4_NONE 0xFFFFFFFFu
#define BVH4_LEVEL 1024u  /* nodes of a level, at most */
#define BVH4_PENDING 16u  /* nodes that a work-item has to make, at most: a subtree has no more than 2 of them for 3 primitives */

/* A node that is to be made: the two children of the binary node, its first position in leaf order, the number of the wide node. Lists of
 * them: [0].x is their length, and they begin at [1]. */
typedef uint4 bvh4_task;
/* A leaf of two primitives and more whose positions are to be written: binary node, first position. Lists: likewise. */
typedef uint2 bvh4_leaf;

/* The tree that is merged, and the one that is made. */
typedef struct bvh4_trees {
    const global float *prims, *nodes;  /* rt_prim and rt_topology_node: 8 words each, alike but for the last of each four */
    const global uint *counts, *order;
    uint max_leaf, first_node, first_leaf;
    global float *to;
    global uint2 *ranges;
    global uint *leaves, *used; /* *used: nodes that are taken */
    global bvh4_leaf *open_leaves;
} bvh4_trees;
#define BVH4_TREES                                                                                                             \
    const global float *prims, const global float *nodes, const global uint *counts, const global uint *order, uint max_leaf, \
        uint first_node, uint first_leaf, global float *to, global uint2 *ranges, global uint *leaves, global uint *used,     \
        global bvh4_leaf *open_leaves
#define BVH4_TAKE_TREES                                                                            \
    const bvh4_trees trees = {prims, nodes,  counts, order, max_leaf,   first_node, first_leaf, \
                              to,    ranges, leaves, used,  open_leaves}

/* A child of a wide node. lo.w, hi.w: the children of a binary node. */
typedef struct bvh4_child {
    float4 lo, hi;
    uint code, size;
} bvh4_child;

RT_INLINE bvh4_child bvh4_load(const bvh4_trees *t, uint code)
{
    bvh4_child child;
    child.code = code;
    const global float *from;
    if (code >= BVH4_SINGLE) {
        child.size = 1u;
        from = t->prims + 8ul * t->order[code & ~BVH4_SINGLE];
    } else {
        child.size = t->counts[code];
        from = t->nodes + 8ul * code;
    }
    child.lo = vload4(0, from);
    child.hi = vload4(1, from);
    return child;
}
RT_INLINE float bvh4_area(const bvh4_child *child)
{
    const float4 size = child->hi - child->lo;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/* The children of a wide node, in leaf order. Returns how many there are. Indices are constants after unrolling, so that children stay
 * in registers. */
RT_INLINE uint bvh4_merge(const bvh4_trees *t, bvh4_task task, bvh4_child child[4])
{
    child[0] = bvh4_load(t, task.x);
    child[1] = bvh4_load(t, task.y);
    child[2] = child[3] = child[1];
#pragma unroll
    for (uint number = 2u; number < 4u; ++number) {
        uint best = 4u;
        float largest = -1.0f;
        bvh4_child opened = child[0];
#pragma unroll
        for (uint c = 0u; c < 4u; ++c) {
            const float area = bvh4_area(&child[c]);
            if (c >= number || child[c].size <= t->max_leaf || !(best == 4u || area > largest)) continue;
            best = c;
            largest = area;
            opened = child[c];
        }
        if (best == 4u) return number;
#pragma unroll
        for (uint c = 3u; c > 0u; --c)
            if (c > best + 1u) child[c] = child[c - 1u];
        const bvh4_child left = bvh4_load(t, as_uint(opened.lo.w)), right = bvh4_load(t, as_uint(opened.hi.w));
#pragma unroll
        for (uint c = 0u; c < 4u; ++c) {
            if (c == best) child[c] = left;
            if (c == best + 1u) child[c] = right;
        }
    }
    return 4u;
}

/* Writes a wide node. Its inner children have the numbers from `below` on, and its leaves of two primitives and more become those from
 * `open` on of the list. */
RT_INLINE void bvh4_write(const bvh4_trees *t, bvh4_task task, const bvh4_child child[4], uint number, uint below, uint open)
{
    uint code[4], first = task.z;
    float middle_x = 0.0f, middle_y = 0.0f;
#pragma unroll
    for (uint c = 0u; c < 4u; ++c) {
        code[c] = BVH4_EMPTY;
        if (c >= number) continue;
        if (child[c].size > t->max_leaf) {
            const uint node = t->first_node + below++;
            code[c] = BVH4_NODE_REF(node);
        } else {
            code[c] = BVH4_MAKE_LEAF(t->first_leaf + first, child[c].size);
            if (child[c].size == 1u)
                t->leaves[first] = t->order[child[c].code & ~BVH4_SINGLE];
            else
                t->open_leaves[1u + open++] = (bvh4_leaf)(child[c].code, first);
        }
        first += child[c].size;
        middle_x += (0.5f * child[c].lo.x + 0.5f * child[c].hi.x) / (float)number;
        middle_y += (0.5f * child[c].lo.y + 0.5f * child[c].hi.y) / (float)number;
    }
    /* Slots as node_slots.cpp assigns them: bit 0 means the high side in x, bit 1 the high side in y. */
    uint slot_of[4] = {4u, 4u, 4u, 4u}, taken = 0u;
#pragma unroll
    for (uint turn = 0u; turn < 4u; ++turn) {
        uint chosen = 4u, slot = 4u;
        float best = 0.0f;
#pragma unroll
        for (uint c = 0u; c < 4u; ++c) {
            const float x = 0.5f * child[c].lo.x + 0.5f * child[c].hi.x - middle_x;
            const float y = 0.5f * child[c].lo.y + 0.5f * child[c].hi.y - middle_y;
#pragma unroll
            for (uint s = 0u; s < 4u; ++s) {
                const float fit = (s & 1u ? x : -x) + (s & 2u ? y : -y);
                if (c >= number || slot_of[c] < 4u || taken >> s & 1u || !(chosen == 4u || fit > best)) continue;
                best = fit;
                chosen = c;
                slot = s;
            }
        }
        taken |= 1u << slot; /* bit 4 if there was no child left */
#pragma unroll
        for (uint c = 0u; c < 4u; ++c)
            if (c == chosen) slot_of[c] = slot;
    }
    const uint index = t->first_node + task.w, turn = index & 7u;
    t->ranges[index] = (uint2)(task.z, first - task.z);
    float row[8][4];
#pragma unroll
    for (uint s = 0u; s < 4u; ++s) {
        float4 lo = (float4)(INFINITY), hi = (float4)(-INFINITY);
        uint ref = BVH4_EMPTY;
#pragma unroll
        for (uint c = 0u; c < 4u; ++c)
            if (slot_of[c] == s) lo = child[c].lo, hi = child[c].hi, ref = code[c];
        row[0][s] = lo.x, row[1][s] = lo.y, row[2][s] = lo.z;
        row[3][s] = hi.x, row[4][s] = hi.y, row[5][s] = hi.z;
        row[6][s] = as_float(ref), row[7][s] = 0.0f;
    }
    global float *const node = t->to + 32ul * index; /* its rows are permuted: bvh4_types.h */
#pragma unroll
    for (uint k = 0u; k < 8u; ++k) vstore4((float4)(row[k][0], row[k][1], row[k][2], row[k][3]), k ^ turn, node);
}

/* What the work-items of a group share while they make nodes in rounds. Two sets of counts: one is cleared while the other is in
 * use. */
typedef struct bvh4_round {
    uint nodes[2], leaves[2], subtrees[2], busy[2], first_node, first_leaf, first_subtree;
} bvh4_round;

/* Takes the places of a round from a counter: *first receives the first one. `team`: which 32 work-items do it, so that several calls
 * wait for memory at the same time. */
RT_INLINE void bvh4_reserve(const local uint *number, global uint *counter, local uint *first, uint team)
{
    if (RT_ITEM == team * RT_WARP % RT_GROUP) *first = *number ? atomic_add(counter, *number) : 0u;
}

/* How many inner children and leaves of two primitives and more a node has. */
RT_INLINE uint2 bvh4_count(const bvh4_trees *t, const bvh4_child child[4], uint number)
{
    uint2 found = (uint2)(0u);
#pragma unroll
    for (uint c = 0u; c < 4u; ++c) {
        if (c < number && child[c].size > t->max_leaf) ++found.x;
        if (c < number && child[c].size <= t->max_leaf && child[c].size > 1u) ++found.y;
    }
    return found;
}
/* The task of an inner child. */
RT_INLINE bvh4_task bvh4_below(const bvh4_child *child, uint first, uint node)
{
    return (bvh4_task)(as_uint(child->lo.w), as_uint(child->hi.w), first, node);
}

/* Says that no node is made and no list is long, and writes the root of a tree of less than two primitives, which has no binary
 * node. */
RT_BUILD_KERNEL bvh4_begin(BVH4_TREES, uint count, uint elements, uint each, const global uint *root, uint has_root, global uint4 *lists,
                           uint list_count, uint list_places)
{
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, elements);
    for (uint e = begin + RT_ITEM; e < end; e += RT_GROUP) ranges[first_node + e] = (uint2)(0u, 0u);
    if (RT_GROUP_NUMBER != 0u) return;
    RT_GLOBAL_BARRIER();
    if (RT_ITEM != 0u) return;
    lists[0] = (uint4)(count > 1u ? 1u : 0u, 0u, 0u, 0u);
    const ulong at = has_root && count > 1u ? root[0] : 0u;
    if (count > 1u) lists[1] = (bvh4_task)(as_uint(nodes[8ul * at + 3u]), as_uint(nodes[8ul * at + 7u]), 0u, 0u);
    open_leaves[0] = (bvh4_leaf)(0u);
    for (uint l = 0u; l < list_count; ++l) lists[2u + l * list_places] = (uint4)(0u);
    *used = 1u;
    if (count > 1u) return;
    BVH4_TAKE_TREES;
    bvh4_child child[4];
    for (uint c = 0u; c < 4u; ++c) {
        child[c].lo = child[c].hi = (float4)(0.0f);
        child[c].code = child[c].size = 0u;
    }
    if (count == 1u) child[0] = bvh4_load(&trees, BVH4_SINGLE);
    bvh4_write(&trees, (bvh4_task)(0u), child, count, 0u, 0u);
}

/* Descends from each subtree of the list `from` to those of at most `least` primitives, which it adds to the list `to_list`. */
RT_BUILD_KERNEL bvh4_open(BVH4_TREES, uint least, global uint4 *lists, uint from, uint to_list)
{
    local bvh4_task level[2][BVH4_LEVEL];
    local uint size[2];
    local bvh4_round round;
    BVH4_TAKE_TREES;
    global uint4 *const found = lists + to_list;
    const uint subtrees = lists[from].x;
    if (RT_ITEM == 0u) round.nodes[0] = round.leaves[0] = round.subtrees[0] = 0u;
    uint set = 0u;
    for (uint s = RT_GROUP_NUMBER; s < subtrees; s += (uint)get_num_groups(0)) {
        if (RT_ITEM == 0u) {
            level[0][0] = lists[from + 1u + s];
            size[0] = 1u;
            size[1] = 0u;
        }
        RT_LOCAL_BARRIER();
        uint side = 0u;
        for (uint now = size[0]; now > 0u; now = size[side]) {
            for (uint begin = 0u; begin < now; begin += RT_GROUP) {
                const bool there = begin + RT_ITEM < now;
                bvh4_child child[4];
                bvh4_task task = (bvh4_task)(0u);
                uint number = 0u, small = 0u;
                uint2 made = (uint2)(0u);
                if (there) {
                    task = level[side][begin + RT_ITEM];
                    number = bvh4_merge(&trees, task, child);
                    made = bvh4_count(&trees, child, number);
#pragma unroll
                    for (uint c = 0u; c < 4u; ++c) small += c < number && child[c].size > max_leaf && child[c].size <= least ? 1u : 0u;
                }
                uint node = made.x ? atomic_add(&round.nodes[set], made.x) : 0u;
                const uint leaf = made.y ? atomic_add(&round.leaves[set], made.y) : 0u;
                uint subtree = small ? atomic_add(&round.subtrees[set], small) : 0u;
                RT_LOCAL_BARRIER();
                bvh4_reserve(&round.nodes[set], used, &round.first_node, 0u);
                bvh4_reserve(&round.leaves[set], (global uint *)open_leaves, &round.first_leaf, 1u);
                bvh4_reserve(&round.subtrees[set], (global uint *)found, &round.first_subtree, 2u);
                if (RT_ITEM == 0u) round.nodes[1u - set] = round.leaves[1u - set] = round.subtrees[1u - set] = 0u;
                RT_LOCAL_BARRIER();
                set = 1u - set;
                if (!there) continue;
                node += round.first_node;
                subtree += round.first_subtree;
                bvh4_write(&trees, task, child, number, node, round.first_leaf + leaf);
                uint first = task.z;
#pragma unroll
                for (uint c = 0u; c < 4u; ++c) {
                    if (c < number && child[c].size > max_leaf) {
                        const bvh4_task below = bvh4_below(&child[c], first, node++);
                        if (child[c].size > least)
                            level[1u - side][atomic_inc(&size[1u - side])] = below;
                        else
                            found[1u + subtree++] = below;
                    }
                    first += child[c].size;
                }
            }
            RT_LOCAL_BARRIER();
            if (RT_ITEM == 0u) size[side] = 0u;
            RT_LOCAL_BARRIER();
            side = 1u - side;
        }
        RT_LOCAL_BARRIER(); /* before the level is used again */
    }
}

/* Makes the subtrees of a list, each by one work-item: of at most 16 primitives. */
RT_BUILD_KERNEL bvh4_close(BVH4_TREES, global uint4 *lists, uint from)
{
    local bvh4_round round;
    BVH4_TAKE_TREES;
    const uint subtrees = lists[from].x;
    if (RT_ITEM == 0u) round.nodes[0] = round.leaves[0] = round.busy[0] = 0u;
    RT_LOCAL_BARRIER();
    uint set = 0u;
    for (uint begin = RT_GROUP_NUMBER * RT_GROUP; begin < subtrees; begin += (uint)get_num_groups(0) * RT_GROUP) {
        bvh4_task pending[BVH4_PENDING];
        uint top = 0u;
        if (begin + RT_ITEM < subtrees) pending[top++] = lists[from + 1u + begin + RT_ITEM];
        for (bool busy = true; busy;) {
            bvh4_child child[4];
            bvh4_task task = (bvh4_task)(0u);
            uint number = 0u;
            uint2 made = (uint2)(0u);
            if (top > 0u) {
                task = pending[--top];
                number = bvh4_merge(&trees, task, child);
                made = bvh4_count(&trees, child, number);
            }
            uint node = made.x ? atomic_add(&round.nodes[set], made.x) : 0u;
            const uint leaf = made.y ? atomic_add(&round.leaves[set], made.y) : 0u;
            if (top + made.x > 0u) round.busy[set] = 1u; /* all write the same */
            RT_LOCAL_BARRIER();
            busy = round.busy[set] != 0u;
            bvh4_reserve(&round.nodes[set], used, &round.first_node, 0u);
            bvh4_reserve(&round.leaves[set], (global uint *)open_leaves, &round.first_leaf, 1u);
            if (RT_ITEM == 0u) round.nodes[1u - set] = round.leaves[1u - set] = round.busy[1u - set] = 0u;
            RT_LOCAL_BARRIER();
            set = 1u - set;
            if (number == 0u) continue;
            node += round.first_node;
            bvh4_write(&trees, task, child, number, node, round.first_leaf + leaf);
            uint first = task.z;
#pragma unroll
            for (uint c = 0u; c < 4u; ++c) {
                if (c < number && child[c].size > max_leaf) pending[top++] = bvh4_below(&child[c], first, node++);
                first += child[c].size;
            }
        }
    }
}

/* Writes the leaf order of the leaves of two primitives and more: of at most BVH4_LEAF_MAX. */
RT_BUILD_KERNEL bvh4_write_leaves(const global float *nodes, const global uint *order, const global bvh4_leaf *open_leaves,
                                  global uint *leaves)
{
    const uint count = open_leaves[0].x;
    for (uint i = RT_GROUP_NUMBER * RT_GROUP + RT_ITEM; i < count; i += (uint)get_num_groups(0) * RT_GROUP) {
        uint stack[BVH4_LEAF_MAX + 1u], top = 0u, at = open_leaves[1u + i].y;
        stack[top++] = open_leaves[1u + i].x;
        while (top > 0u) {
            const uint code = stack[--top];
            if (code >= BVH4_SINGLE) {
                leaves[at++] = order[code & ~BVH4_SINGLE];
            } else {
                stack[top++] = as_uint(nodes[8ul * code + 7u]);
                stack[top++] = as_uint(nodes[8ul * code + 3u]);
            }
        }
    }
}

/* Writes the box of a child of a node, from those of the primitives below it. Returns the child's share of the expected cost of a ray. */
RT_INLINE float bvh4_fit(const rt_fit *fit, global float *nodes, uint index, uint slot)
{
    global float *const node = nodes + 32ul * index + slot;
    const uint turn = index & 7u, code = as_uint(node[4u * (6u ^ turn)]);
    if (code == BVH4_EMPTY) return 0.0f; /* its box is that of nothing */
    const bool leaf = code >= BVH4_LEAF;
    const uint2 below = leaf ? (uint2)(BVH4_LEAF_FIRST(code) - fit->first_leaf, BVH4_LEAF_COUNT(code))
                             : fit->ranges[BVH4_INDEX(code)];
    const rt_block box = rt_fit_box(fit, below);
    node[4u * (0u ^ turn)] = box.lo.x;
    node[4u * (1u ^ turn)] = box.lo.y;
    node[4u * (2u ^ turn)] = box.lo.z;
    node[4u * (3u ^ turn)] = box.hi.x;
    node[4u * (4u ^ turn)] = box.hi.y;
    node[4u * (5u ^ turn)] = box.hi.z;
    return rt_fit_cost(fit, box, leaf, below.y);
}
#define RT_FIT_KERNEL bvh4_refit
#define RT_FIT_NODE float
#define RT_FIT_WIDTH 4u
#define RT_FIT_CHILD bvh4_fit
#include "cl/build/fit_nodes.h"
