/* ploc_merge.h -- merges clusters that are neighbours along a curve: the same code for host (C++) and device (OpenCL C), so that
 * both build the same tree.
 *
 * The radix tree over the codes of the curve says in which order ranges of places are joined (Benthin, Meister, Barczak, Mehalwal,
 * Tsakok, Kensler 2024, "H-PLOC: Hierarchical Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction"). A
 * range of more than 16 primitives keeps at most 16 clusters. Where two ranges are joined, their clusters are merged: each one looks
 * for the neighbour with which it has the smallest box, and two that have chosen each other become a node (Meister, Bittner 2018,
 * "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction").
 *
 * Whoever includes this file defines before it: ploc_tree, PLOC_INLINE, PLOC_HIGHEST_BIT(x) of an rt_u64; and behind it the five
 * functions that are declared below.
 */
#ifndef PLOC_MERGE_H
#define PLOC_MERGE_H

#define PLOC_SINGLE 0x80000000u /* a primitive: RT_TOPOLOGY_LEAF | its place along the curve */
#define PLOC_NONE 0xFFFFFFFFu
#define PLOC_KEPT 16u    /* clusters of a range, at most */
#define PLOC_RADIUS 5u   /* neighbours on either side among which a cluster looks for the nearest */
#define PLOC_OPEN 160u   /* ranges of a part of the curve that wait for their siblings: two for each bit of a code and a place */

/* What is kept of a cluster between two joins. 16 B. */
typedef struct ploc_place {
    rt_u32 code;   /* the node, or PLOC_SINGLE | place; PLOC_NONE: there is no cluster */
    rt_u32 name;   /* one of the places below it: no other cluster has this name */
    rt_u32 height; /* nodes on the way to a primitive, at most */
    rt_u32 count;  /* primitives */
} ploc_place;
typedef struct ploc_cluster {
    rt_f32 lo_x, lo_y, lo_z, hi_x, hi_y, hi_z; /* no arrays: these stay in registers */
    ploc_place place;
} ploc_cluster;

/* The cluster that a place describes. */
PLOC_INLINE ploc_cluster ploc_load(const ploc_tree *t, ploc_place place);
PLOC_INLINE void ploc_write(const ploc_tree *t, rt_u32 node, const ploc_cluster *box, rt_u32 left, rt_u32 right);
/* What was kept at a place of the curve. */
PLOC_INLINE ploc_place ploc_place_at(const ploc_tree *t, rt_u32 at);
PLOC_INLINE void ploc_keep(const ploc_tree *t, rt_u32 at, ploc_place place);
/* The code at a place of the curve. */
PLOC_INLINE rt_u64 ploc_code(const ploc_tree *t, rt_u32 at);

PLOC_INLINE ploc_place ploc_single(rt_u32 at)
{
    const ploc_place place = {PLOC_SINGLE | at, at, 0u, 1u};
    return place;
}

PLOC_INLINE rt_f32 ploc_least(rt_f32 a, rt_f32 b) { return a < b ? a : b; }
PLOC_INLINE rt_f32 ploc_most(rt_f32 a, rt_f32 b) { return a > b ? a : b; }

/* Half the surface of the box of two clusters. The largest float stands for what is larger, or no number: then there is always a pair
 * whose clusters have chosen each other. */
PLOC_INLINE rt_f32 ploc_area(const ploc_cluster *a, const ploc_cluster *b)
{
    const rt_f32 x = ploc_most(a->hi_x, b->hi_x) - ploc_least(a->lo_x, b->lo_x);
    const rt_f32 y = ploc_most(a->hi_y, b->hi_y) - ploc_least(a->lo_y, b->lo_y);
    const rt_f32 z = ploc_most(a->hi_z, b->hi_z) - ploc_least(a->lo_z, b->lo_z);
    const rt_f32 area = x * y + y * z + z * x;
    return area < FLT_MAX ? area : FLT_MAX;
}

/* Makes a node of two clusters, of which a comes first. Each node takes its number from the name that vanishes, so all are different,
 * from 0 to count - 2, and nobody counts. */
PLOC_INLINE ploc_cluster ploc_pair(const ploc_tree *t, const ploc_cluster *a, const ploc_cluster *b)
{
    ploc_cluster both;
    both.lo_x = ploc_least(a->lo_x, b->lo_x), both.hi_x = ploc_most(a->hi_x, b->hi_x);
    both.lo_y = ploc_least(a->lo_y, b->lo_y), both.hi_y = ploc_most(a->hi_y, b->hi_y);
    both.lo_z = ploc_least(a->lo_z, b->lo_z), both.hi_z = ploc_most(a->hi_z, b->hi_z);
    both.place.code = b->place.name - 1u;
    both.place.name = a->place.name;
    both.place.height = (a->place.height > b->place.height ? a->place.height : b->place.height) + 1u;
    both.place.count = a->place.count + b->place.count;
    ploc_write(t, both.place.code, &both, a->place.code, b->place.code);
    return both;
}

/* How soon the places i and i + 1 part: the highest bit of the codes, or of the places if the codes are equal, that differs. */
PLOC_INLINE rt_u32 ploc_rank(const ploc_tree *t, rt_u32 i)
{
    const rt_u64 differ = ploc_code(t, i) ^ ploc_code(t, i + 1u);
    return differ ? 64u + PLOC_HIGHEST_BIT(differ) : PLOC_HIGHEST_BIT((rt_u64)(i ^ (i + 1u)));
}

/* ---- one work-item alone */

/* Reads the clusters of a range behind the n that are there. radix: each range has one. Returns how many there are then. */
PLOC_INLINE rt_u32 ploc_take(const ploc_tree *t, rt_u32 start, rt_u32 end, bool radix, ploc_cluster *clusters, rt_u32 n)
{
    const rt_u32 size = end - start;
    if (size <= (radix ? 1u : PLOC_KEPT)) {
        for (rt_u32 i = 0u; i < size; ++i) clusters[n++] = ploc_load(t, ploc_single(start + i));
        return n;
    }
    for (rt_u32 i = 0u; i < (radix ? 1u : PLOC_KEPT); ++i) {
        const ploc_place place = ploc_place_at(t, start + i);
        if (place.code == PLOC_NONE) break;
        clusters[n++] = ploc_load(t, place);
    }
    return n;
}

/* Merges the pairs that have chosen each other. Returns how many clusters are left. */
PLOC_INLINE rt_u32 ploc_round(const ploc_tree *t, ploc_cluster *clusters, rt_u32 n)
{
    rt_u32 chosen[2u * PLOC_KEPT];
    for (rt_u32 i = 0u; i < n; ++i) {
        rt_f32 least = INFINITY;
        const rt_u32 first = i > PLOC_RADIUS ? i - PLOC_RADIUS : 0u;
        chosen[i] = i;
        for (rt_u32 j = first; j < n && j <= i + PLOC_RADIUS; ++j) {
            if (j == i) continue;
            const rt_f32 area = ploc_area(&clusters[i], &clusters[j]);
            if (area < least) least = area, chosen[i] = j; /* the first of several */
        }
    }
    rt_u32 left = 0u;
    for (rt_u32 i = 0u; i < n; ++i) {
        const rt_u32 j = chosen[i];
        if (chosen[j] != i)
            clusters[left++] = clusters[i];
        else if (i < j)
            clusters[left++] = ploc_pair(t, &clusters[i], &clusters[j]);
    }
    return left;
}

/* Joins the ranges start .. split - 1 and split .. end - 1. whole: all places; then *root is the root. */
PLOC_INLINE void ploc_join(const ploc_tree *t, rt_u32 start, rt_u32 split, rt_u32 end, bool whole, bool radix, ploc_place *root)
{
    if (end - start <= PLOC_KEPT && !whole && !radix) return;
    ploc_cluster clusters[2u * PLOC_KEPT];
    rt_u32 n = ploc_take(t, split, end, radix, clusters, ploc_take(t, start, split, radix, clusters, 0u));
    const rt_u32 until = whole || radix ? 1u : PLOC_KEPT;
    while (n > until) n = ploc_round(t, clusters, n);
    if (whole) *root = clusters[0].place;
    const ploc_place none = {PLOC_NONE, 0u, 0u, 0u};
    for (rt_u32 i = 0u; i < (radix ? 1u : PLOC_KEPT) && !whole; ++i) ploc_keep(t, start + i, i < n ? clusters[i].place : none);
}

/* Adds the range first .. end - 1 behind the `open` ranges that begin at starts[], and joins it with them as the radix tree says. Returns
 * how many ranges are open then. */
PLOC_INLINE rt_u32 ploc_add(const ploc_tree *t, rt_u32 count, rt_u32 first, rt_u32 end, bool radix, rt_u32 *starts, rt_u32 open,
                            ploc_place *root)
{
    for (; open > 0u; --open) {
        const rt_u32 start = starts[open - 1u], between = ploc_rank(t, first - 1u);
        if (end < count && ploc_rank(t, end - 1u) < between) break; /* its sibling is on the right */
        if (start > 0u && ploc_rank(t, start - 1u) < between) break; /* the range before is not whole */
        ploc_join(t, start, first, end, start == 0u && end == count, radix, root);
        first = start;
    }
    starts[open++] = first;
    return open;
}
#endif
