/* vote.h -- work-items that decide together: RT_VOTERS neighbours, all of whom must call these at the same place. On NVIDIA's devices
 * they are a warp, which agrees by votes and shuffles (PTX; their OpenCL has no sub-groups); elsewhere a work-item is by itself. */
#ifndef RT_VOTE_H
#define RT_VOTE_H

#if !RT_CPU && !defined(RT_PORTABLE) && defined(__NV_CL_C_VERSION)

#define RT_WARP_VOTES
#define RT_VOTERS 32u
RT_INLINE uint rt_voter(void) { return (uint)get_local_id(0) & 31u; }
/* Bits of those whose value is not 0. */
RT_INLINE uint rt_ballot(uint value)
{
    uint bits;
    __asm__ volatile("{ .reg .pred p; setp.ne.u32 p, %1, 0; vote.sync.ballot.b32 %0, p, 0xffffffff; }" : "=r"(bits) : "r"(value));
    return bits;
}
/* Whether it is so for any of them. A branch by it is the same for all, which the compiler sees. */
RT_INLINE bool rt_vote(bool value)
{
    uint any;
    __asm__ volatile("{ .reg .pred p; setp.ne.u32 p, %1, 0; vote.sync.any.pred p, p, 0xffffffff; selp.u32 %0, 1, 0, p; }"
                     : "=r"(any)
                     : "r"((uint)value));
    return any != 0u;
}
/* The value of one of them. */
RT_INLINE uint rt_value_of(uint voter, uint value)
{
    uint its;
    __asm__ volatile("shfl.sync.idx.b32 %0, %1, %2, 31, 0xffffffff;" : "=r"(its) : "r"(value), "r"(voter));
    return its;
}

#else

#define RT_VOTERS 1u
RT_INLINE uint rt_voter(void) { return 0u; }
RT_INLINE uint rt_ballot(uint value) { return value ? 1u : 0u; }
RT_INLINE bool rt_vote(bool value) { return value; }
RT_INLINE uint rt_value_of(uint voter, uint value) { return value; }

#endif

/* Where a warp's rays go together each work-item has RT_EACH of them (warp_rays.cl). */
#define RT_FOR_EACH_OWN(i) _Pragma("unroll") for (uint i = 0; i < RT_EACH; ++i)

#endif
