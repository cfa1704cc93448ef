/* ploc_build.cl -- a binary tree by clustering along a Morton curve: ploc_merge.h explains it.
 *
 * On devices with warps, each primitive's work-item climbs the radix tree, and the second of two siblings to arrive goes on (Apetrei
 * 2014, "Fast and Simple Agglomerative LBVH Construction"); where ranges are joined, the whole warp merges their clusters. Elsewhere
 * no group may read what another has written, so each work-item takes a part of the curve, and one joins what is left. */
#include "cl/rt_shared.h"
#pragma OPENCL FP_CONTRACT OFF /* the same tree as the host's */

#define PLOC_INLINE RT_INLINE
#define PLOC_HIGHEST_BIT(x) (63u - (uint)clz(x))
typedef ulong rt_u64;

typedef struct ploc_tree {
    const global float *prims; /* rt_prim: 8 words each */
    const global uint *order;
    const global ulong *codes;
    global float *nodes; /* rt_topology_node: 8 words each */
    global uint *counts;
    global uint4 *places;
} ploc_tree;
#define PLOC_TREE                                                                                                              \
    const global float *prims, const global uint *order, const global ulong *codes, global float *nodes, global uint *counts, \
        global uint4 *places
#define PLOC_TAKE_TREE const ploc_tree tree = {prims, order, codes, nodes, counts, places}

#include "ploc_merge.h"

RT_INLINE ploc_cluster ploc_load(const ploc_tree *t, ploc_place place)
{
    const global float *const box = place.code >= PLOC_SINGLE ? t->prims + 8ul * t->order[place.code & ~PLOC_SINGLE]
                                                              : t->nodes + 8ul * place.code;
    const float4 lo = vload4(0, box), hi = vload4(1, box);
    ploc_cluster cluster;
    cluster.lo_x = lo.x, cluster.lo_y = lo.y, cluster.lo_z = lo.z;
    cluster.hi_x = hi.x, cluster.hi_y = hi.y, cluster.hi_z = hi.z;
    cluster.place = place;
    return cluster;
}
RT_INLINE void ploc_write(const ploc_tree *t, uint node, const ploc_cluster *box, uint left, uint right)
{
    vstore4((float4)(box->lo_x, box->lo_y, box->lo_z, as_float(left)), 0, t->nodes + 8ul * node);
    vstore4((float4)(box->hi_x, box->hi_y, box->hi_z, as_float(right)), 1, t->nodes + 8ul * node);
    t->counts[node] = box->place.count;
}
RT_INLINE ploc_place ploc_place_at(const ploc_tree *t, uint at)
{
    const uint4 words = t->places[at];
    const ploc_place place = {words.x, words.y, words.z, words.w};
    return place;
}
RT_INLINE void ploc_keep(const ploc_tree *t, uint at, ploc_place place)
{
    t->places[at] = (uint4)(place.code, place.name, place.height, place.count);
}
RT_INLINE ulong ploc_code(const ploc_tree *t, uint at) { return t->codes[at]; }

/* result: the number of the root, and the height of the tree. */
RT_INLINE void ploc_finish(global uint *result, ploc_place root)
{
    result[0] = root.code;
    result[1] = root.height;
}

#ifdef RT_WARPS

/* Says that the range *start .. *last is there. If its sibling is there too, returns true; then the range holds both, and the second
 * begins at *split. siblings: for each place but the last, 1 + the far end of the sibling that has arrived there; 0: none has. The
 * second to arrive leaves it at 0, for the next build. */
RT_INLINE bool ploc_arrive(const ploc_tree *t, uint count, global uint *siblings, uint *start, uint *last, uint *split)
{
    const bool is_right = *last == count - 1u || (*start > 0u && ploc_rank(t, *start - 1u) < ploc_rank(t, *last));
    global uint *const meeting = siblings + (is_right ? *start - 1u : *last);
    const uint other = atomic_xchg(meeting, 1u + (is_right ? *last : *start));
    if (other == 0u) return false;
    *meeting = 0u;
    *split = is_right ? *start : *last + 1u;
    if (is_right)
        *start = other - 1u;
    else
        *last = other - 1u;
    return true;
}

RT_INLINE ploc_place ploc_shuffle_place(ploc_place place, uint lane)
{
    ploc_place of_lane;
    of_lane.code = rt_shuffle(place.code, lane);
    of_lane.name = rt_shuffle(place.name, lane);
    of_lane.height = rt_shuffle(place.height, lane);
    of_lane.count = rt_shuffle(place.count, lane);
    return of_lane;
}
RT_INLINE ploc_cluster ploc_shuffle_box(ploc_cluster cluster, uint lane)
{
    ploc_cluster of_lane = cluster;
    of_lane.lo_x = rt_shuffle_float(cluster.lo_x, lane), of_lane.hi_x = rt_shuffle_float(cluster.hi_x, lane);
    of_lane.lo_y = rt_shuffle_float(cluster.lo_y, lane), of_lane.hi_y = rt_shuffle_float(cluster.hi_y, lane);
    of_lane.lo_z = rt_shuffle_float(cluster.lo_z, lane), of_lane.hi_z = rt_shuffle_float(cluster.hi_z, lane);
    return of_lane;
}

/* The clusters of a warp while they are put together. */
typedef struct ploc_row {
    float4 lo, hi;
    uint4 place;
} ploc_row;

RT_INLINE void ploc_put(local ploc_row *row, const ploc_cluster *cluster)
{
    row->lo = (float4)(cluster->lo_x, cluster->lo_y, cluster->lo_z, 0.0f);
    row->hi = (float4)(cluster->hi_x, cluster->hi_y, cluster->hi_z, 0.0f);
    row->place = (uint4)(cluster->place.code, cluster->place.name, cluster->place.height, cluster->place.count);
}
RT_INLINE ploc_cluster ploc_get(const local ploc_row *row)
{
    const float4 lo = row->lo, hi = row->hi;
    const uint4 words = row->place;
    const ploc_cluster cluster = {lo.x, lo.y, lo.z, hi.x, hi.y, hi.z, {words.x, words.y, words.z, words.w}};
    return cluster;
}

/* ploc_join() by a warp: a lane has a cluster. rows: room for the warp. kept: for the group's places from first_kept on, the clusters
 * of its ranges, if the whole range is among them (in_group). A range that keeps its primitives has them there. */
RT_INLINE void ploc_join_together(const ploc_tree *t, local ploc_row *rows, local ploc_row *kept, uint first_kept, bool in_group, uint start,
                                  uint split, uint end, bool whole, global uint *result)
{
    const uint lane = RT_ITEM % RT_WARP, lower = (1u << lane) - 1u, k = lane % PLOC_KEPT;
    const uint from = lane < PLOC_KEPT ? start : split, size = lane < PLOC_KEPT ? split - start : end - split;
    const ploc_place none = {PLOC_NONE, 0u, 0u, 0u};
    ploc_cluster cluster = {0.0f, 0.0f, 0.0f, 0.0f, 0.0f, 0.0f, none};
    if (k < size) {
        if (in_group) {
            cluster = ploc_get(kept + from + k - first_kept);
        } else {
            cluster.place = size <= PLOC_KEPT ? ploc_single(from + k) : ploc_place_at(t, from + k);
            if (cluster.place.code != PLOC_NONE) cluster = ploc_load(t, cluster.place);
        }
    }
    const uint there = rt_ballot(cluster.place.code != PLOC_NONE), on_left = popcount(there & 0xFFFFu);
    const uint source = lane < on_left ? lane : (PLOC_KEPT + lane - on_left) % RT_WARP;
    const ploc_place place = ploc_shuffle_place(cluster.place, source);
    cluster = ploc_shuffle_box(cluster, source);
    cluster.place = place;
    uint n = popcount(there);
    for (const uint until = whole ? 1u : PLOC_KEPT; n > until;) {
        float least = INFINITY;
        uint chosen = lane;
#pragma unroll
        for (uint r = 1u; r <= PLOC_RADIUS; ++r) {
            const ploc_cluster other = ploc_shuffle_box(cluster, (lane + r) % RT_WARP);
            const float after = ploc_area(&cluster, &other), before = rt_shuffle_float(after, (lane - r) % RT_WARP);
            if (lane + r < n && (after < least || (after == least && lane + r < chosen))) least = after, chosen = lane + r;
            if (lane >= r && lane < n && (before < least || (before == least && lane - r < chosen)))
                least = before, chosen = lane - r;
        }
        const uint their_choice = rt_shuffle(chosen, chosen);
        const bool is_pair = lane < n && their_choice == lane;
        ploc_cluster other = ploc_shuffle_box(cluster, chosen);
        other.place = ploc_shuffle_place(cluster.place, chosen);
        if (is_pair && lane < chosen) cluster = ploc_pair(t, &cluster, &other);
        const bool stays = lane < n && !(is_pair && lane > chosen);
        const uint staying = rt_ballot(stays);
        if (stays) ploc_put(rows + popcount(staying & lower), &cluster);
        RT_WARP_BARRIER();
        n = popcount(staying);
        if (lane < n) cluster = ploc_get(rows + lane);
        RT_WARP_BARRIER();
    }
    if (whole && lane == 0u) ploc_finish(result, cluster.place);
    if (whole || lane >= PLOC_KEPT) return;
    if (lane >= n) cluster.place = none;
    ploc_keep(t, start + lane, cluster.place);
    if (in_group) ploc_put(kept + start + lane - first_kept, &cluster);
}

/* The largest range of the radix tree that holds place i, has no more than PLOC_KEPT primitives, and begins at i. Returns its last place,
 * or PLOC_NONE if a larger one begins before i. ranks[k]: that of place i - PLOC_KEPT + k. */
RT_INLINE uint ploc_small_range(const local uint *ranks, uint count, uint i)
{
    uint last = i;
    while (last - i < PLOC_KEPT - 1u) {
        const uint before = i > 0u ? ranks[PLOC_KEPT - 1u] : PLOC_NONE;
        const uint after = last + 1u < count ? ranks[last + PLOC_KEPT - i] : PLOC_NONE;
        if (before == after) break; /* both are PLOC_NONE: it has all places */
        uint end = last;
        if (before < after) {
            uint first = i - 1u;
            while (first > 0u && end - first < PLOC_KEPT && ranks[first - 1u + PLOC_KEPT - i] < before) --first;
            if (end - first < PLOC_KEPT) return PLOC_NONE;
            break;
        }
        for (++end; end + 1u < count && end - i < PLOC_KEPT && ranks[end + PLOC_KEPT - i] < after;) ++end;
        if (end - i >= PLOC_KEPT) break;
        last = end;
    }
    return last;
}

/* The largest of several neighbours of RT_GROUP + 1 ranks: upto[i] of ranks 0 .. i, after[i] of ranks i + 1 .. RT_GROUP. */
RT_INLINE void ploc_scan_ranks(const local uint *ranks, local uint *upto, local uint *after)
{
    uint a = ranks[RT_ITEM], b = ranks[RT_ITEM + 1u];
    upto[RT_ITEM] = a;
    after[RT_ITEM] = b;
    RT_LOCAL_BARRIER();
    for (uint step = 1u; step < RT_GROUP; step *= 2u) {
        if (RT_ITEM >= step) a = max(a, upto[RT_ITEM - step]);
        if (RT_ITEM + step < RT_GROUP) b = max(b, after[RT_ITEM + step]);
        RT_LOCAL_BARRIER();
        upto[RT_ITEM] = a;
        after[RT_ITEM] = b;
        RT_LOCAL_BARRIER();
    }
}

/* A warp joins the ranges of those lanes for which `joins` is true. */
RT_INLINE void ploc_join_all(const ploc_tree *t, local ploc_row *rows, local ploc_row *kept, uint first_kept, bool in_group, bool joins,
                             uint start, uint split, uint last, uint count, global uint *result)
{
    for (uint joining = rt_ballot(joins); joining != 0u;) {
        const uint lane = 31u - clz(joining);
        joining ^= 1u << lane;
        const uint first = rt_shuffle(start, lane), end = rt_shuffle(last, lane) + 1u;
        ploc_join_together(t, rows, kept, first_kept, in_group, first, rt_shuffle(split, lane), end, end - first == count, result);
    }
}

/* Builds the parts of the tree that lie within the places of a group: their ranges meet in local memory. waiting: those ranges whose
 * parent does not; [0].x is their number. */
RT_BUILD_KERNEL ploc_windows(PLOC_TREE, uint count, global uint2 *waiting, global uint *result)
{
    local ploc_row rows[RT_GROUP], kept[RT_GROUP];
    local uint ranks[RT_GROUP + 2u * PLOC_KEPT], upto[RT_GROUP], after[RT_GROUP], met[RT_GROUP], number, first_waiting;
    PLOC_TAKE_TREE;
    uint start = (uint)get_global_id(0), split = 0u;
    const uint window = start - RT_ITEM;
    for (uint k = RT_ITEM; k < RT_GROUP + 2u * PLOC_KEPT; k += RT_GROUP) {
        const uint place = window + k - PLOC_KEPT; /* wraps round before the first */
        ranks[k] = place < count - 1u ? ploc_rank(&tree, place) : PLOC_NONE;
    }
    if (start < count) {
        const ploc_cluster single = ploc_load(&tree, ploc_single(start));
        ploc_put(kept + RT_ITEM, &single);
    }
    met[RT_ITEM] = 0u;
    if (RT_ITEM == 0u) number = 0u;
    RT_LOCAL_BARRIER();
    ploc_scan_ranks(ranks + PLOC_KEPT - 1u, upto, after);
    local ploc_row *const of_warp = rows + RT_ITEM / RT_WARP * RT_WARP;

    /* Ranges that keep all their primitives need no sibling to be found, so the climb begins at the largest of them. */
    uint last = start < count ? ploc_small_range(ranks + RT_ITEM, count, start) : PLOC_NONE;
    bool climbs = last != PLOC_NONE;
    const bool all = climbs && last - start == count - 1u; /* there is no larger one; any split will do */
    ploc_join_all(&tree, of_warp, kept, window, true, all, start, start + 1u, last, count, result);
    if (all) climbs = false;
    bool here = climbs && last < window + RT_GROUP;
    while (rt_ballot(here) != 0u) {
        bool joins = false;
        if (here) {
            const uint before = ranks[start - 1u - window + PLOC_KEPT], behind = ranks[last - window + PLOC_KEPT];
            const bool is_right = before < behind;
            const uint between = is_right ? start - 1u : last, rank = min(before, behind);
            /* The parent lies here if a larger rank is on either side. */
            here = (is_right ? start > window : last + 1u < window + RT_GROUP) && upto[between - window] > rank &&
                   after[between - window + 1u] > rank;
            if (here) {
                const uint other = atomic_xchg(&met[between - window], 1u + (is_right ? last : start));
                joins = other != 0u;
                here = climbs = joins;
                split = between + 1u;
                if (joins && is_right) start = other - 1u;
                if (joins && !is_right) last = other - 1u;
            }
        }
        if (rt_ballot(joins) == 0u) continue;
        RT_GROUP_FENCE();
        ploc_join_all(&tree, of_warp, kept, window, true, joins, start, split, last, count, result);
        if (joins && last - start == count - 1u) here = climbs = false;
        RT_GROUP_FENCE();
        RT_WARP_BARRIER();
    }
    const uint mine = climbs ? atomic_inc(&number) : 0u;
    RT_LOCAL_BARRIER();
    if (RT_ITEM == 0u) first_waiting = number ? 1u + atomic_add((global uint *)waiting, number) : 0u;
    RT_LOCAL_BARRIER();
    if (climbs) waiting[first_waiting + mine] = (uint2)(start, last);
}

/* Builds the rest: from the ranges that wait to the root. */
RT_BUILD_KERNEL ploc_climb(PLOC_TREE, uint count, const global uint2 *waiting, global uint *siblings, global uint *result)
{
    local ploc_row rows[RT_GROUP];
    PLOC_TAKE_TREE;
    const uint ranges = waiting[0].x, warps = (uint)get_global_size(0) / RT_WARP, warp = (uint)get_global_id(0) / RT_WARP;
    /* Each warp takes a range before one takes two: the joins of a warp come one after the other. */
    for (uint next = warp; next < ranges; next += warps * RT_WARP) {
        const uint mine = next + RT_ITEM % RT_WARP * warps;
        bool climbs = mine < ranges;
        uint start = climbs ? waiting[1u + mine].x : 0u, last = climbs ? waiting[1u + mine].y : 0u, split = 0u;
        while (rt_ballot(climbs) != 0u) {
            if (climbs) climbs = ploc_arrive(&tree, count, siblings, &start, &last, &split);
            if (rt_ballot(climbs) == 0u) break;
            RT_DEVICE_FENCE();
            ploc_join_all(&tree, rows + RT_ITEM / RT_WARP * RT_WARP, rows, 0u, false, climbs, start, split, last, count, result);
            if (climbs && last - start == count - 1u) climbs = false;
            RT_DEVICE_FENCE();
            RT_WARP_BARRIER();
        }
    }
}

/* Builds the radix tree instead, if the tree is higher than `limit`. */
RT_BUILD_KERNEL ploc_limit(PLOC_TREE, uint count, global uint2 *waiting, global uint *siblings, global uint *result, uint limit)
{
    if (get_global_id(0) == 0u) waiting[0].x = 0u; /* for the next build */
    if (result[1] <= limit) return;
    PLOC_TAKE_TREE;
    uint start = (uint)get_global_id(0), last = start, split = 0u;
    if (start >= count) return;
    while (ploc_arrive(&tree, count, siblings, &start, &last, &split)) {
        RT_DEVICE_FENCE();
        const bool whole = last - start == count - 1u;
        ploc_place root;
        ploc_join(&tree, start, split, last + 1u, whole, true, &root);
        if (whole) {
            result[0] = root.code; /* the height stays: other groups read it */
            return;
        }
        RT_DEVICE_FENCE();
    }
}

#else

/* Each work-item builds what it can of its part of the curve. pending: PLOC_OPEN starts of ranges for each part, before them their
 * number. */
RT_BUILD_KERNEL ploc_parts(PLOC_TREE, uint count, uint each, global uint *pending, global uint *result)
{
    const uint part = (uint)get_global_id(0), begin = part * each;
    if (begin >= count) return;
    PLOC_TAKE_TREE;
    uint starts[PLOC_OPEN + 1u], open = 0u;
    ploc_place root = ploc_single(0u);
    for (uint i = begin; i < min(begin + each, count); ++i) open = ploc_add(&tree, count, i, i + 1u, false, starts, open, &root);
    global uint *const kept = pending + part * (PLOC_OPEN + 1u);
    kept[0] = open;
    for (uint i = 0u; i < open; ++i) kept[1u + i] = starts[i];
    if (each >= count) ploc_finish(result, root);
}

/* One work-item joins what is left, and builds the radix tree instead if the tree is higher than `limit`. */
RT_BUILD_KERNEL ploc_join_parts(PLOC_TREE, uint count, uint each, global uint *pending, global uint *result, uint limit)
{
    if (get_global_id(0) != 0u) return;
    PLOC_TAKE_TREE;
    uint starts[PLOC_OPEN + 1u], open = 0u;
    ploc_place root = ploc_single(0u);
    for (uint begin = 0u, part = 0u; begin < count && each < count; begin += each, ++part) {
        const global uint *const kept = pending + part * (PLOC_OPEN + 1u);
        const uint ranges = kept[0], end = min(begin + each, count);
        for (uint r = 0u; r < ranges; ++r)
            open = ploc_add(&tree, count, kept[1u + r], r + 1u < ranges ? kept[2u + r] : end, false, starts, open, &root);
    }
    if (each < count) ploc_finish(result, root);
    if (result[1] <= limit) return;
    open = 0u;
    for (uint i = 0u; i < count; ++i) open = ploc_add(&tree, count, i, i + 1u, true, starts, open, &root);
    ploc_finish(result, root);
}
#endif
