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
#define RT_GLOBAL_BARRIER()
#else
#define RT_LOCAL_BARRIER() barrier(CLK_LOCAL_MEM_FENCE)
#define RT_GLOBAL_BARRIER() barrier(CLK_GLOBAL_MEM_FENCE)

/* Defines a scan for one type: returns the sums of `value` over the work-items before this one; *total: over all. Vectors are summed
 * component by component. shared: 2 * RT_GROUP elements. All work-items of the group call it together (Hillis, Steele 1986, "Data
 * Parallel Algorithms"). The last barrier is there because the memory may be used again. */
#define RT_DEFINE_GROUP_SCAN(name, type)                                              \
    RT_INLINE type name(local type *shared, type value, type *total)                  \
    {                                                                                 \
        const uint item = RT_ITEM;                                                    \
        local type *from = shared, *to = shared + RT_GROUP;                           \
        from[item] = value;                                                           \
        RT_LOCAL_BARRIER();                                                           \
        for (uint step = 1u; step < RT_GROUP; step *= 2u) {                           \
            to[item] = item >= step ? from[item] + from[item - step] : from[item];    \
            RT_LOCAL_BARRIER();                                                       \
            local type *const other = from;                                           \
            from = to;                                                                \
            to = other;                                                               \
        }                                                                             \
        const type all = from[RT_GROUP - 1u], upto = from[item];                      \
        RT_LOCAL_BARRIER();                                                           \
        *total = all;                                                                 \
        return upto - value;                                                          \
    }
RT_DEFINE_GROUP_SCAN(rt_group_scan, uint)
RT_DEFINE_GROUP_SCAN(rt_group_scan4, uint4)
#endif
#endif
