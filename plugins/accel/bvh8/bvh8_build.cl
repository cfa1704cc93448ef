/* bvh8_build.cl -- refits nodes of eight children on the device. */
#include "cl/build/fit.h"
#include "cl/rt_shared.h"
#include "bvh8_types.h"

RT_INLINE float bvh8_fit(const rt_fit *fit, global bvh8_node *nodes, uint index, uint slot)
{
    global bvh8_node *const node = nodes + index;
    const uint code = node->child[slot];
    if (code == BVH8_EMPTY) return 0.0f; /* its box is that of nothing */
    const bool leaf = code >= BVH8_LEAF;
    const uint2 below = leaf ? (uint2)(BVH8_LEAF_FIRST(code) - fit->first_leaf, BVH8_LEAF_COUNT(code)) : fit->ranges[code];
    const rt_block box = rt_fit_box(fit, below);
    node->plane[0][slot] = box.lo.x;
    node->plane[1][slot] = box.lo.y;
    node->plane[2][slot] = box.lo.z;
    node->plane[3][slot] = box.hi.x;
    node->plane[4][slot] = box.hi.y;
    node->plane[5][slot] = box.hi.z;
    return rt_fit_cost(fit, box, leaf, below.y);
}
#define RT_FIT_KERNEL bvh8_refit
#define RT_FIT_NODE bvh8_node
#define RT_FIT_WIDTH 8u
#define RT_FIT_CHILD bvh8_fit
#include "cl/build/fit_nodes.h"
