/* cwbvh_build.cl -- refits compressed nodes on the device: boxes of the children, then the grid of the node around them. The bytes are
 * those of quantize.cpp and of the library's grid.cpp, which explain them. */
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#pragma OPENCL FP_CONTRACT OFF
#include "cl/build/fit.h"
#include "cl/rt_shared.h"
#include "cwbvh_types.h"

#define CWBVH_PLANES_OF_AXIS 255
#define CWBVH_FINEST_OF_COORDINATE 24

/* 2^exponent, and the exponent of a number above 0. */
RT_INLINE double cwbvh_power(int exponent) { return as_double((ulong)(exponent + 1023) << 52); }
RT_INLINE int cwbvh_exponent(double x) { return (int)(as_ulong(x) >> 52) - 1023; }
/* The byte of a plane that bounds a coordinate from above. base: coordinate of byte 0. */
RT_INLINE int cwbvh_upper(float plane, double base, double per_cell)
{
    const double at = (plane - base) * per_cell + (double)CWBVH_MARGIN;
    const int whole = (int)at;
    return whole + ((double)whole < at ? 1 : 0);
}

/* Writes the planes and the origin of one axis. low, high: the children's bounds; empty: the bits of slots without a child. Returns the
 * exponent of the cell at its place in `cells`. */
RT_INLINE uint cwbvh_fit_axis(const float low[8], const float high[8], uint empty, uint axis, global cwbvh_node *node)
{
    float lo = FLT_MAX, hi = -FLT_MAX, origin = as_float(0x7FC00000u); /* NaN: no grid holds the axis */
    for (uint s = 0u; s < 8u; ++s) {
        if (empty >> s & 1u) continue;
        lo = low[s] < lo ? low[s] : lo;
        hi = hi < high[s] ? high[s] : hi;
    }
    if (empty == 255u) lo = hi = 0.0f;
    const double extent = (double)hi - (double)lo, farthest = fmax(fabs((double)lo), fabs((double)hi));
    int exponent = CWBVH_LEAST_EXPONENT;
    if (extent > 0.0) exponent = max(exponent, cwbvh_exponent(extent / (double)CWBVH_PLANES_OF_AXIS) + 1);
    if (farthest > 0.0) exponent = max(exponent, cwbvh_exponent(farthest) - CWBVH_FINEST_OF_COORDINATE);
    double base = 0.0, per_cell = 0.0;
    bool bounded = false;
    for (; exponent <= CWBVH_MOST_EXPONENT && !bounded; ++exponent) {
        const double cell = cwbvh_power(exponent), at = lo - ((double)CWBVH_MARGIN + (double)CWBVH_BIAS) * cell;
        if (at < -(double)FLT_MAX) break;
        origin = convert_float_rtn(at);
        base = origin + (double)CWBVH_BIAS * cell;
        per_cell = cwbvh_power(-exponent);
        bounded = cwbvh_upper(hi, base, per_cell) <= CWBVH_PLANES_OF_AXIS;
    }
    exponent = bounded ? exponent - 1 : 0;
    uint planes[4] = {0u, 0u, 0u, 0u};
    for (uint s = 0u; s < 8u; ++s) {
        const bool none = !bounded || (empty >> s & 1u) != 0u;
        const uint lower = none ? 255u : (uint)(int)((low[s] - base) * per_cell - (double)CWBVH_MARGIN);
        const uint upper = none ? 0u : (uint)cwbvh_upper(high[s], base, per_cell);
        planes[s / 4u] |= lower << 8u * (s % 4u);
        planes[2u + s / 4u] |= upper << 8u * (s % 4u);
    }
    node->origin[axis] = bounded ? origin : as_float(0x7FC00000u);
    for (uint w = 0u; w < 4u; ++w) node->planes[axis][w] = planes[w];
    return (uint)(exponent + CWBVH_EXPONENT_BIAS) << 8u * axis;
}

/* Fits nodes as the kernel of cl/build/fit_nodes.h does. On a GPU eight neighbouring work-items share a node: each finds the box of one
 * child, then three of them write an axis each. */
RT_BUILD_KERNEL cwbvh_refit(global cwbvh_node *nodes, const global uint2 *ranges, const global rt_block *blocks, uint count,
                            uint first_node, uint elements, uint each, uint first_leaf, uint root, float node_cost,
                            float primitive_cost, global float *costs)
{
    const rt_fit fit = {ranges, blocks, count, first_leaf, node_cost, primitive_cost};
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, elements);
#if RT_GROUP == 1
    const uint at_once = 1u, mine = 0u, item = 0u, slots = 8u, axes = 3u;
    rt_block boxes[8];
    float cost[8];
    uint cells[8];
#else
    const uint at_once = RT_GROUP / 8u, mine = RT_ITEM / 8u, item = RT_ITEM % 8u, slots = 1u, axes = 1u;
    local rt_block boxes_of_group[RT_GROUP];
    local float cost_of_group[RT_GROUP];
    local uint cells_of_group[RT_GROUP];
    local rt_block *const boxes = boxes_of_group + 8u * mine;
    local float *const cost = cost_of_group + 8u * mine;
    local uint *const cells = cells_of_group + 8u * mine;
#endif
    for (uint next = begin; next < end; next += at_once) {
        const uint e = next + mine, index = first_node + e;
        const uint2 all = e < end ? ranges[index] : (uint2)(0u);
        global cwbvh_node *const node = nodes + index;
        const uint inner = all.y > 0u ? CWBVH_INNER(node) : 0u, primitives = all.y > 0u ? node->primitives : 0u;
        uint filled = inner; /* slots with a child */
        for (uint s = 0u; s < 8u; ++s) filled |= (primitives >> 4u * s & 15u) != 0u ? 1u << s : 0u;
        for (uint s = item; s < item + slots; ++s) {
            cost[s] = 0.0f;
            if (!(filled >> s & 1u)) continue;
            const bool leaf = !(inner >> s & 1u);
            const uint2 below = leaf ? (uint2)(node->first_leaf + CWBVH_RANK(primitives, 1u << 4u * s) - first_leaf,
                                               popcount(primitives >> 4u * s & 15u))
                                     : ranges[node->first_child + CWBVH_RANK(inner, 1u << s)];
            const rt_block box = rt_fit_box(&fit, below);
            boxes[s] = box;
            cost[s] = rt_fit_cost(&fit, box, leaf, below.y);
        }
        RT_LOCAL_BARRIER();
        for (uint axis = item; axis < min(item + axes, 3u) && all.y > 0u; ++axis) {
            float low[8], high[8];
            for (uint s = 0u; s < 8u; ++s) {
                const bool is = (filled >> s & 1u) != 0u;
                low[s] = !is ? 0.0f : axis == 0u ? boxes[s].lo.x : axis == 1u ? boxes[s].lo.y : boxes[s].lo.z;
                high[s] = !is ? 0.0f : axis == 0u ? boxes[s].hi.x : axis == 1u ? boxes[s].hi.y : boxes[s].hi.z;
            }
            cells[axis] = cwbvh_fit_axis(low, high, ~filled & 255u, axis, node);
        }
        RT_LOCAL_BARRIER();
        if (e < end && item == 0u) {
            float sum = cost[0];
            for (uint s = 1u; s < 8u; ++s) sum += cost[s];
            if (index == root) sum += node_cost * rt_block_area(rt_fit_box(&fit, all));
            costs[e] = all.y > 0u ? sum : 0.0f;
            if (all.y > 0u) node->cells = (node->cells & 0xFF000000u) | cells[0] | cells[1] | cells[2];
        }
        RT_LOCAL_BARRIER();
    }
}
