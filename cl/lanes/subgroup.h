/* subgroup.h -- subgroups: RT_SUBGROUP_SIZE neighbouring work-items that exchange values without memory.
 *
 * All work-items of a subgroup must call these functions at the same place. On NVIDIA's devices a subgroup is a warp, and the
 * functions are PTX votes and shuffles, since their OpenCL has no sub-groups. Elsewhere a subgroup is one work-item. */
#ifndef RT_SUBGROUP_H
#define RT_SUBGROUP_H

#if !RT_CPU && !defined(RT_PORTABLE) && defined(__NV_CL_C_VERSION)

#define RT_HAS_SUBGROUPS
#define RT_SUBGROUP_SIZE 32u
RT_INLINE uint rt_subgroup_local_id(void) { return (uint)get_local_id(0) & 31u; }
/* Returns the bits of the work-items that have a value other than 0. */
RT_INLINE uint rt_subgroup_ballot(uint value)
{
    uint bits;
    __asm__ volatile("{ .reg .pred p; setp.ne.u32 p, %1, 0; vote.sync.ballot.b32 %0, p, 0xffffffff; }" : "=r"(bits) : "r"(value));
    return bits;
}
/* Whether `value` is true for any of them. The compiler sees that a branch on the result is uniform. */
RT_INLINE bool rt_subgroup_any(bool value)
{
    uint any;
    __asm__ volatile("{ .reg .pred p; setp.ne.u32 p, %1, 0; vote.sync.any.pred p, p, 0xffffffff; selp.u32 %0, 1, 0, p; }"
                     : "=r"(any)
                     : "r"((uint)value));
    return any != 0u;
}
/* The value of the work-item `voter`. */
RT_INLINE uint rt_subgroup_broadcast(uint voter, uint value)
{
    uint its;
    __asm__ volatile("shfl.sync.idx.b32 %0, %1, %2, 31, 0xffffffff;" : "=r"(its) : "r"(value), "r"(voter));
    return its;
}

#else

#define RT_SUBGROUP_SIZE 1u
RT_INLINE uint rt_subgroup_local_id(void) { return 0u; }
RT_INLINE uint rt_subgroup_ballot(uint value) { return value ? 1u : 0u; }
RT_INLINE bool rt_subgroup_any(bool value) { return value; }
RT_INLINE uint rt_subgroup_broadcast(uint voter, uint value) { return value; }

#endif

/* A loop over the RT_RAYS_PER_ITEM rays of a work-item, in programs that trace the rays of a warp together (warp_rays.cl). */
#define RT_FOR_EACH_RAY_OF_ITEM(i) _Pragma("unroll") for (uint i = 0; i < RT_RAYS_PER_ITEM; ++i)

#endif
