/* fit.h -- what a node's child is fitted to: the box of its primitives, and its share of the expected cost of a ray. */
#ifndef RT_FIT_H
#define RT_FIT_H

/* What a child is fitted to. */
typedef struct rt_fit {
    const global uint2 *ranges;    /* rt_device_tree::ranges */
    const global rt_block *blocks; /* of `count` primitives */
    uint count, first_leaf;
    float node_cost, primitive_cost;
} rt_fit;

/* The box of a child which has these positions in leaf order, from 0 on. */
RT_INLINE rt_block rt_fit_box(const rt_fit *fit, uint2 positions)
{
    return rt_box_of_range(fit->blocks, fit->count, positions.x, positions.x + positions.y);
}
RT_INLINE float rt_fit_cost(const rt_fit *fit, rt_block box, bool leaf, uint primitives)
{
    return rt_block_area(box) * (leaf ? fit->primitive_cost * (float)primitives : fit->node_cost);
}
#endif
