/* reduce.cl -- the bounds of many boxes and of their centres, in two passes: each work-group reduces a part, then one group
 * reduces the groups' results. Minima and maxima have no rounding, so the result does not depend on the order. */

#pragma OPENCL FP_CONTRACT OFF /* centres are the same on every device */

/* 0..2 the least corner of all boxes, 3..5 of all centres; 6..8 and 9..11: the greatest. */
typedef struct rt_build_bounds {
    float at[12];
} rt_build_bounds;

RT_INLINE rt_build_bounds rt_no_bounds(void)
{
    rt_build_bounds b;
    for (uint k = 0u; k < 12u; ++k) b.at[k] = k < 6u ? INFINITY : -INFINITY;
    return b;
}
RT_INLINE void rt_add_box(rt_build_bounds *b, const global rt_build_box *box)
{
    for (uint k = 0u; k < 3u; ++k) {
        const float lo = box->lo[k], hi = box->hi[k], centre = 0.5f * lo + 0.5f * hi;
        b->at[k] = min(b->at[k], lo);
        b->at[3u + k] = min(b->at[3u + k], centre);
        b->at[6u + k] = max(b->at[6u + k], hi);
        b->at[9u + k] = max(b->at[9u + k], centre);
    }
}

RT_INLINE void rt_add_bounds(rt_build_bounds *b, const global rt_build_bounds *more)
{
    for (uint k = 0u; k < 12u; ++k) b->at[k] = k < 6u ? min(b->at[k], more->at[k]) : max(b->at[k], more->at[k]);
}

#if RT_GROUP == 1
#define RT_SHARED_BOUNDS
#define RT_ALL_BOUNDS(b)
#else
RT_INLINE void rt_group_bounds(local float *shared, rt_build_bounds *b)
{
    const uint item = RT_ITEM;
    for (uint k = 0u; k < 12u; ++k) shared[k * RT_GROUP + item] = b->at[k];
    RT_LOCAL_BARRIER();
    for (uint step = RT_GROUP / 2u; step > 0u; step /= 2u) {
        if (item < step)
            for (uint k = 0u; k < 12u; ++k) {
                const float a = shared[k * RT_GROUP + item], c = shared[k * RT_GROUP + item + step];
                shared[k * RT_GROUP + item] = k < 6u ? min(a, c) : max(a, c);
            }
        RT_LOCAL_BARRIER();
    }
    for (uint k = 0u; k < 12u; ++k) b->at[k] = shared[k * RT_GROUP];
}
#define RT_SHARED_BOUNDS local float shared[12u * RT_GROUP];
#define RT_ALL_BOUNDS(b) rt_group_bounds(shared, b)
#endif

/* parts[g]: the bounds of the boxes first + i of group g, i from g * each on. */
RT_BUILD_KERNEL reduce_boxes(const global rt_build_box *boxes, uint first, uint count, uint each, global rt_build_bounds *parts)
{
    RT_SHARED_BOUNDS
    const uint begin = RT_GROUP_NUMBER * each, end = min(begin + each, count);
    rt_build_bounds b = rt_no_bounds();
    for (uint i = begin + RT_ITEM; i < end; i += RT_GROUP) rt_add_box(&b, boxes + first + i);
    RT_ALL_BOUNDS(&b);
    if (RT_ITEM == 0u) parts[RT_GROUP_NUMBER] = b;
}

/* One work-group: *result is the bounds of all parts. */
RT_BUILD_KERNEL reduce_parts(const global rt_build_bounds *parts, uint count, global rt_build_bounds *result)
{
    RT_SHARED_BOUNDS
    rt_build_bounds b = rt_no_bounds();
    for (uint i = RT_ITEM; i < count; i += RT_GROUP) rt_add_bounds(&b, parts + i);
    RT_ALL_BOUNDS(&b);
    if (RT_ITEM == 0u) *result = b;
}
