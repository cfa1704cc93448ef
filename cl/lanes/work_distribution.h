/* work_distribution.h -- work-items that take work and room together: one atomic for all of them.
 *
 * A wave is RT_TEAM_SIZE work-items that run the same way through a kernel's outer loop: on NVIDIA's devices a warp, which agrees by
 * votes (subgroup.h); elsewhere a work-group, which agrees through local memory; on a CPU one work-item. Every work-item of a wave must
 * call these, at the same place. */
#ifndef RT_WORK_DISTRIBUTION_H
#define RT_WORK_DISTRIBUTION_H

#if RT_CPU
#define RT_TEAM_SIZE 1u
#elif defined(RT_HAS_SUBGROUPS)
#define RT_TEAM_SIZE RT_SUBGROUP_SIZE
#else
#define RT_TEAM_SIZE ((uint)RT_LOCAL_SIZE)
#endif
/* uints of local memory that a work-group lends to the functions below. */
#define RT_TEAM_SCRATCH (RT_LOCAL_SIZE + 1)

#if RT_CPU

RT_INLINE uint rt_team_item(void) { return 0u; }
RT_INLINE uint rt_team_broadcast(uint value, local uint *scratch) { return value; }
RT_INLINE uint rt_team_exclusive_sum(uint value, uint *sum, local uint *scratch)
{
    *sum = value;
    return 0u;
}

#elif defined(RT_HAS_SUBGROUPS)

RT_INLINE uint rt_team_item(void) { return rt_subgroup_local_id(); }
RT_INLINE uint rt_team_broadcast(uint value, local uint *scratch) { return rt_subgroup_broadcast(0u, value); }
/* value: 1 at most. */
RT_INLINE uint rt_team_exclusive_sum(uint value, uint *sum, local uint *scratch)
{
    const uint ones = rt_subgroup_ballot(value);
    *sum = popcount(ones);
    return popcount(ones & ((1u << rt_team_item()) - 1u));
}

#else

RT_INLINE uint rt_team_item(void) { return (uint)get_local_id(0); }
RT_INLINE uint rt_team_broadcast(uint value, local uint *scratch)
{
    if (get_local_id(0) == 0) scratch[RT_LOCAL_SIZE] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    const uint first = scratch[RT_LOCAL_SIZE];
    barrier(CLK_LOCAL_MEM_FENCE);
    return first;
}
/* Hillis, Steele 1986, Data Parallel Algorithms. */
RT_INLINE uint rt_team_exclusive_sum(uint value, uint *sum, local uint *scratch)
{
    const uint item = (uint)get_local_id(0);
    uint through = value;
    scratch[item] = value;
    barrier(CLK_LOCAL_MEM_FENCE);
    for (uint step = 1u; step < (uint)RT_LOCAL_SIZE; step *= 2u) {
        const uint before = item >= step ? scratch[item - step] : 0u;
        barrier(CLK_LOCAL_MEM_FENCE);
        through += before;
        scratch[item] = through;
        barrier(CLK_LOCAL_MEM_FENCE);
    }
    *sum = scratch[RT_LOCAL_SIZE - 1];
    barrier(CLK_LOCAL_MEM_FENCE);
    return through - value;
}

#endif

/* rt_team_broadcast: the value of the wave's first work-item. rt_team_exclusive_sum: the values of the work-items before this one, added up;
 * *sum: of all. What follows is made of them. */

/* Leaves a loop once the condition holds for none of the wave. Work-groups go on to its end. */
#if RT_CPU
#define RT_TEAM_BREAK_UNLESS(condition)                                                                                          \
    if (!(condition)) break;
#elif defined(RT_HAS_SUBGROUPS)
#define RT_TEAM_BREAK_UNLESS(condition)                                                                                          \
    if (rt_subgroup_ballot(condition) == 0u) break;
#else
#define RT_TEAM_BREAK_UNLESS(condition)
#endif

/* Gives out the chunks of a piece of work, each to one wave: in order, to whoever is free; *tickets counts them. Work-groups that are
 * waves take turns instead: PoCL 3.1 loses work-items where a loop with barriers is left from its middle. */
#if RT_CPU || defined(RT_HAS_SUBGROUPS)
RT_INLINE uint rt_team_ticket(volatile global uint *tickets, local uint *scratch)
{
    uint ticket = 0u;
    if (rt_team_item() == 0u) ticket = atomic_inc(tickets);
    return rt_team_broadcast(ticket, scratch);
}
#define RT_FOR_CHUNKS(chunk, chunks, tickets, scratch)                                                                           \
    for (uint chunk; (chunk = rt_team_ticket(tickets, scratch)) < (chunks);)
#else
#define RT_FOR_CHUNKS(chunk, chunks, tickets, scratch)                                                                           \
    for (uint chunk = (uint)get_group_id(0); chunk < (chunks); chunk += (uint)get_num_groups(0))
#endif

/* Room for `amount` in an array whose next free place *next is; the wave's is in one piece, from what is returned on, and may lie
 * beyond the array's end. */
RT_INLINE uint rt_team_claim(volatile global uint *next, uint amount, local uint *scratch)
{
    uint first = 0u;
    if (rt_team_item() == 0u && amount != 0u) first = atomic_add(next, amount);
    return rt_team_broadcast(first, scratch);
}

#endif
