/* bvh4_build.cl -- merges the nodes of a binary tree on the device to nodes of up to four children, and refits such nodes.
 *
 * A node takes in the children of its largest child until it has four (Wald, Benthin, Boulos 2008). Which nodes of the binary tree
 * remain is thus known from the root down only, and a pass for each level would leave most of the device without work. So it takes
 * three steps, each of which has work for all: each binary node chooses its children as if it remained; each place of the leaf order
 * goes down from the root through those choices, and the one in the middle of a node's range gives numbers to the children of that
 * node; each node that has a number is written. Numbers come from one counter: their order differs from run to run, the tree does
 * not. */
#include "cl/build/fit.h"
#include "cl/rt_shared.h"
#include "bvh4_types.h"

#define BVH4_SINGLE 0x80000000u /* a child of the binary tree that is one primitive: RT_TOPOLOGY_LEAF | its place in order */

/* What a binary node takes in, in leaf order. Size 0: none. 32 B. */
typedef struct bvh4_choice {
    uint code[4], size[4];
} bvh4_choice;
/* A wide node: the binary node, its first position in leaf order. */
typedef uint2 bvh4_task;

/* The tree that is merged. */
typedef struct bvh4_trees {
    const global float *prims, *nodes; /* rt_prim and rt_topology_node: 8 words each, alike but for the last of each four */
    const global uint *counts, *order;
    uint max_leaf;
} bvh4_trees;
#define BVH4_TREES \
    const global float *prims, const global float *nodes, const global uint *counts, const global uint *order, uint max_leaf
#define BVH4_TAKE_TREES const bvh4_trees trees = {prims, nodes, counts, order, max_leaf}

/* A child of a wide node. lo.w, hi.w: the children of a binary node. */
typedef struct bvh4_child {
    float4 lo, hi;
    uint code, size;
} bvh4_child;

/* A child of `size` primitives; of size 0 it has the box of a point. */
RT_INLINE bvh4_child bvh4_box(const bvh4_trees *t, uint code, uint size)
{
    bvh4_child child;
    child.code = code;
    child.size = size;
    child.lo = child.hi = (float4)(0.0f);
    if (size == 0u) return child;
    const global float *const from = code >= BVH4_SINGLE ? t->prims + 8ul * t->order[code & ~BVH4_SINGLE] : t->nodes + 8ul * code;
    child.lo = vload4(0, from);
    child.hi = vload4(1, from);
    return child;
}
RT_INLINE bvh4_child bvh4_load(const bvh4_trees *t, uint code)
{
    return bvh4_box(t, code, code >= BVH4_SINGLE ? 1u : t->counts[code]);
}
RT_INLINE float bvh4_area(const bvh4_child *child)
{
    const float4 size = child->hi - child->lo;
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

/* The children of a wide node, in leaf order. Returns how many there are. Indices are constants after unrolling, so that children stay
 * in registers. */
RT_INLINE uint bvh4_merge(const bvh4_trees *t, uint node, bvh4_child child[4])
{
    child[0] = bvh4_load(t, as_uint(t->nodes[8ul * node + 3u]));
    child[1] = bvh4_load(t, as_uint(t->nodes[8ul * node + 7u]));
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

/* Writes a node of `number` children, whose codes are those of the wide tree. permutation: of its rows (bvh4_types.h). */
RT_INLINE void bvh4_store(const bvh4_child child[4], uint number, uint permutation, global float *node)
{
    float middle_x = 0.0f, middle_y = 0.0f;
#pragma unroll
    for (uint c = 0u; c < 4u; ++c) {
        if (c >= number) continue;
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
    float row[8][4];
#pragma unroll
    for (uint s = 0u; s < 4u; ++s) {
        float4 lo = (float4)(INFINITY), hi = (float4)(-INFINITY);
        uint ref = BVH4_EMPTY;
#pragma unroll
        for (uint c = 0u; c < 4u; ++c)
            if (slot_of[c] == s) lo = child[c].lo, hi = child[c].hi, ref = child[c].code;
        row[0][s] = lo.x, row[1][s] = lo.y, row[2][s] = lo.z;
        row[3][s] = hi.x, row[4][s] = hi.y, row[5][s] = hi.z;
        row[6][s] = as_float(ref), row[7][s] = 0.0f;
    }
#pragma unroll
    for (uint k = 0u; k < 8u; ++k) vstore4((float4)(row[k][0], row[k][1], row[k][2], row[k][3]), k ^ permutation, node);
}

/* Each binary node chooses its children. The wide tree has a root, and no node yet below it. */
RT_BUILD_KERNEL bvh4_choose(BVH4_TREES, uint count, uint each, global bvh4_choice *choices, global uint *used)
{
    BVH4_TAKE_TREES;
    if (RT_GROUP_NUMBER == 0u && RT_ITEM == 0u) *used = 1u;
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, max(count, 1u) - 1u);
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        if (counts[i] <= min(max_leaf, count - 1u)) continue; /* it is a leaf, or in one */
        bvh4_child child[4];
        const uint number = bvh4_merge(&trees, i, child);
        uint code[4], size[4];
#pragma unroll
        for (uint c = 0u; c < 4u; ++c) {
            code[c] = child[c].code;
            size[c] = c < number ? child[c].size : 0u;
        }
        global uint *const to = (global uint *)(choices + i);
        vstore4((uint4)(code[0], code[1], code[2], code[3]), 0, to);
        vstore4((uint4)(size[0], size[1], size[2], size[3]), 1, to);
    }
}

/* Where a way down from the root is: a node or a leaf, its first position and how many there are. */
typedef struct bvh4_way {
    uint code, first, size;
} bvh4_way;

/* Goes from a wide node to its child that has position `at`. */
RT_INLINE bvh4_way bvh4_down(uint4 code, uint4 size, bvh4_way way, uint at)
{
    const uint first[4] = {way.first, way.first + size.x, way.first + size.x + size.y, way.first + size.x + size.y + size.z};
    const bvh4_way last = {code.w, first[3], size.w}, third = {code.z, first[2], size.z}, second = {code.y, first[1], size.y};
    way.code = code.x;
    way.size = size.x;
    if (at >= first[1]) way = second;
    if (size.z && at >= first[2]) way = third;
    if (size.w && at >= first[3]) way = last;
    return way;
}
/* How many of the children are wide nodes. */
RT_INLINE uint bvh4_inner(uint4 size, uint max_leaf)
{
    return (size.x > max_leaf) + (size.y > max_leaf) + (size.z > max_leaf) + (size.w > max_leaf);
}
/* Whether a position gives numbers to a node's children: that in the middle of its range. The first one would have much to do, as a
 * node and its first children begin at the same place. */
RT_INLINE bool bvh4_numbers(bvh4_way way, uint at) { return at == way.first + way.size / 2u; }

/* Each position finds its primitive, and gives numbers to children of wide nodes: consecutive ones, the first of which goes to `below` of
 * the binary node. */
RT_BUILD_KERNEL bvh4_number(BVH4_TREES, uint count, uint each, const global bvh4_choice *choices, const global uint *root, uint has_root,
                            global uint *used, global bvh4_task *tasks, global uint *below, global uint *leaves)
{
    local uint taken, first_taken;
    const bvh4_way top = {has_root && count > 1u ? root[0] : 0u, 0u, count};
    if (RT_GROUP_NUMBER == 0u && RT_ITEM == 0u) tasks[0] = (bvh4_task)(top.code, 0u);
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    for (uint from = begin; from < end; from += RT_GROUP) {
        const uint at = from + RT_ITEM;
        uint made = 0u;
        if (at < end) {
            bvh4_way way = top;
            if (count > 1u) {
                do {
                    const global uint *const choice = (const global uint *)(choices + way.code);
                    const uint4 code = vload4(0, choice), size = vload4(1, choice);
                    if (bvh4_numbers(way, at)) made += bvh4_inner(size, max_leaf);
                    way = bvh4_down(code, size, way, at);
                } while (way.size > max_leaf);
                while (way.size > 1u) { /* inside a leaf */
                    const uint left = as_uint(nodes[8ul * way.code + 3u]), size = left >= BVH4_SINGLE ? 1u : counts[left];
                    const bool right = at >= way.first + size;
                    way.code = right ? as_uint(nodes[8ul * way.code + 7u]) : left;
                    way.first += right ? size : 0u;
                    way.size = right ? way.size - size : size;
                }
            }
            leaves[at] = order[way.code & ~BVH4_SINGLE];
        }
        if (RT_ITEM == 0u) taken = 0u;
        RT_LOCAL_BARRIER();
        uint number = made ? atomic_add(&taken, made) : 0u;
        RT_LOCAL_BARRIER();
        if (RT_ITEM == 0u) first_taken = taken ? atomic_add(used, taken) : 0u;
        RT_LOCAL_BARRIER();
        number += first_taken;
        for (bvh4_way way = top; made > 0u;) {
            const global uint *const choice = (const global uint *)(choices + way.code);
            const uint4 code = vload4(0, choice), size = vload4(1, choice);
            if (bvh4_numbers(way, at)) {
                below[way.code] = number;
                uint first = way.first;
                if (size.x > max_leaf) tasks[number++] = (bvh4_task)(code.x, first);
                first += size.x;
                if (size.y > max_leaf) tasks[number++] = (bvh4_task)(code.y, first);
                first += size.y;
                if (size.z > max_leaf) tasks[number++] = (bvh4_task)(code.z, first);
                first += size.z;
                if (size.w > max_leaf) tasks[number++] = (bvh4_task)(code.w, first);
                made -= bvh4_inner(size, max_leaf);
            }
            way = bvh4_down(code, size, way, at);
        }
    }
}

/* Writes the wide nodes and their ranges of leaves. Binary nodes that became no wide node get an empty range. */
RT_BUILD_KERNEL bvh4_write(BVH4_TREES, uint count, uint elements, uint each, const global bvh4_choice *choices, const global uint *used,
                           const global bvh4_task *tasks, const global uint *below, uint first_node, uint first_leaf, global float *to,
                           global uint2 *ranges)
{
    BVH4_TAKE_TREES;
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, elements), there = *used;
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) {
        const uint index = first_node + i;
        if (i >= there) {
            ranges[index] = (uint2)(0u, 0u);
            continue;
        }
        const bvh4_task task = tasks[i];
        bvh4_child child[4];
        uint inner = 0u;
        if (count > 1u) {
            inner = below[task.x]; /* nothing, if no child is a node */
            const global uint *const choice = (const global uint *)(choices + task.x);
            const uint4 code = vload4(0, choice), size = vload4(1, choice);
            const uint codes[4] = {code.x, code.y, code.z, code.w}, sizes[4] = {size.x, size.y, size.z, size.w};
#pragma unroll
            for (uint c = 0u; c < 4u; ++c) child[c] = bvh4_box(&trees, codes[c], sizes[c]);
        } else { /* no binary node: the tree of one primitive or none */
#pragma unroll
            for (uint c = 0u; c < 4u; ++c) child[c] = bvh4_box(&trees, BVH4_SINGLE, c < count ? 1u : 0u);
        }
        uint first = task.y, number = 0u;
#pragma unroll
        for (uint c = 0u; c < 4u; ++c) {
            child[c].code = BVH4_EMPTY;
            if (child[c].size == 0u) continue;
            if (child[c].size > max_leaf) {
                const uint node = first_node + inner++;
                child[c].code = BVH4_NODE_REF(node);
            } else {
                child[c].code = BVH4_MAKE_LEAF(first_leaf + first, child[c].size);
            }
            first += child[c].size;
            ++number;
        }
        ranges[index] = (uint2)(task.y, first - task.y);
        bvh4_store(child, number, index & 7u, to + 32ul * index);
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
