/* groups.h -- how the kernels of builds divide their work, and the scan of a work-group.
 *
 * The host gives RT_GROUP, the number of work-items of every work-group: 256 on a GPU. On a CPU it is 1: a work-item then does a
 * group's work in a loop, which is the faster way there, and no barrier is needed.
 *
 * OpenCL 1.2 promises neither order nor progress between work-groups. So no group waits for another, and nothing that one group
 * writes is read by another of the same launch, unless RT_DEVICE_FENCE is there. */
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

/* On NVIDIA's devices (RT_WARPS) 32 neighbouring work-items of a group, a warp, talk to each other by instructions of PTX. All
 * work-items of the warp call each of these together. */
#define RT_WARP 32u
#ifdef RT_WARPS
/* The bits of the work-items of the warp that have the same value. */
RT_INLINE uint rt_match(uint value)
{
    uint bits;
    __asm__ volatile("match.any.sync.b32 %0, %1, 0xffffffff;" : "=r"(bits) : "r"(value));
    return bits;
}
/* The bits of those for which `is` is true. */
RT_INLINE uint rt_ballot(bool is)
{
    uint bits;
    __asm__ volatile("{ .reg .pred p; setp.ne.u32 p, %1, 0; vote.sync.ballot.b32 %0, p, 0xffffffff; }"
                     : "=r"(bits)
                     : "r"((uint)is));
    return bits;
}
/* The value that work-item `lane` of the warp has. */
RT_INLINE uint rt_shuffle(uint value, uint lane)
{
    uint of_lane;
    __asm__ volatile("shfl.sync.idx.b32 %0, %1, %2, 0x1f, 0xffffffff;" : "=r"(of_lane) : "r"(value), "r"(lane));
    return of_lane;
}
RT_INLINE float rt_shuffle_float(float value, uint lane) { return as_float(rt_shuffle(as_uint(value), lane)); }
#define RT_WARP_BARRIER() __asm__ volatile("bar.warp.sync 0xffffffff;" ::: "memory")
/* What this work-item has written is seen by those that see, after a fence of their own, what it writes next; on the whole device
 * (NVIDIA, PTX ISA, "Memory Consistency Model"). So the last of several work-groups to arrive may go on with what the others have
 * written. None may wait for another. */
#define RT_DEVICE_FENCE() __asm__ volatile("fence.acq_rel.gpu;" ::: "memory")
/* The same for work-items of one group. */
#define RT_GROUP_FENCE() __asm__ volatile("fence.acq_rel.cta;" ::: "memory")
#else
#define RT_WARP_BARRIER() RT_LOCAL_BARRIER()
#endif
#endif
