/* groups.h -- how the kernels of builds divide their work, and the scan of a work-group.
 *
 * The host gives RT_GROUP, the number of work-items of every work-group: 256 on a GPU. On a CPU it is 1: a work-item then does a
 * group's work in a loop, which is the faster way there, and no barrier is needed.
 *
 * OpenCL 1.2 promises neither order nor progress between work-groups. So no group waits for another, and nothing that one group
 * writes is read by another of the same launch. */
#ifndef RT_GROUPS_H
#define RT_GROUPS_H

#define RT_INLINE static inline __attribute__((always_inline))
#define RT_BUILD_KERNEL kernel __attribute__((reqd_work_group_size(RT_GROUP, 1, 1))) void
#define RT_ITEM ((uint)get_local_id(0))
#define RT_GROUP_NUMBER ((uint)get_group_id(0))

#if RT_GROUP == 1
#define RT_LOCAL_BARRIER()
#else
#define RT_LOCAL_BARRIER() barrier(CLK_LOCAL_MEM_FENCE)

/* Returns the sums of `value`, component by component, over the work-items before this one; *total: over all. shared: 2 * RT_GROUP
 * elements. All work-items of the group call it together (Hillis, Steele 1986, "Data Parallel Algorithms"). */
RT_INLINE uint4 rt_group_scan4(local uint4 *shared, uint4 value, uint4 *total)
{
    const uint item = RT_ITEM;
    local uint4 *from = shared, *to = shared + RT_GROUP;
    from[item] = value;
    RT_LOCAL_BARRIER();
    for (uint step = 1u; step < RT_GROUP; step *= 2u) {
        to[item] = item >= step ? from[item] + from[item - step] : from[item];
        RT_LOCAL_BARRIER();
        local uint4 *const other = from;
        from = to;
        to = other;
    }
    const uint4 all = from[RT_GROUP - 1u], upto = from[item];
    RT_LOCAL_BARRIER(); /* the memory may be used again */
    *total = all;
    return upto - value;
}
/* The same for one number. */
RT_INLINE uint rt_group_scan(local uint *shared, uint value, uint *total)
{
    const uint item = RT_ITEM;
    local uint *from = shared, *to = shared + RT_GROUP;
    from[item] = value;
    RT_LOCAL_BARRIER();
    for (uint step = 1u; step < RT_GROUP; step *= 2u) {
        to[item] = item >= step ? from[item] + from[item - step] : from[item];
        RT_LOCAL_BARRIER();
        local uint *const other = from;
        from = to;
        to = other;
    }
    const uint all = from[RT_GROUP - 1u], upto = from[item];
    RT_LOCAL_BARRIER();
    *total = all;
    return upto - value;
}
#endif
#endif
