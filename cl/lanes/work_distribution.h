/* work_distribution.h -- teams of work-items that claim work and memory with one atomic operation for all of them.
 *
 * A team is RT_TEAM_SIZE work-items that run through a kernel's outer loop in step. It is a warp on NVIDIA's devices, where it
 * uses subgroup.h; one work-item on a CPU; elsewhere a work-group, which uses local memory. Every work-item of a team must call
 * these functions, at the same place. */
#ifndef RT_WORK_DISTRIBUTION_H
#define RT_WORK_DISTRIBUTION_H

#if RT_CPU
#define RT_TEAM_SIZE 1u
#elif defined(RT_HAS_SUBGROUPS)
#define RT_TEAM_SIZE RT_SUBGROUP_SIZE
#else
#define RT_TEAM_SIZE ((uint)RT_LOCAL_SIZE)
#endif
/* Declares what the functions below need of a work-group's local memory. They need none where a team is smaller than a work-group:
 * PoCL 6.0 aborts on a local variable that no instruction of its kernel uses. */
#if RT_CPU || defined(RT_HAS_SUBGROUPS)
#define RT_TEAM_SCRATCH(name) local uint *const name = 0;
#else
#define RT_TEAM_SCRATCH(name) local uint name[RT_LOCAL_SIZE + 1];
#endif

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
/* `value` is 0 or 1. */
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
/* Hillis, Steele 1986, "Data Parallel Algorithms". */
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

/* rt_team_broadcast returns the value of the team's first work-item. rt_team_exclusive_sum returns the sum of the values of the
 * work-items before this one; *sum is that of all. The functions below are made of these two. */

/* Leaves a loop if the condition holds for no work-item of the team. Where a team is a work-group, the loop runs to its end. */
#if RT_CPU
#define RT_TEAM_BREAK_UNLESS(condition)                                                                                        \
    if (!(condition)) break;
#elif defined(RT_HAS_SUBGROUPS)
#define RT_TEAM_BREAK_UNLESS(condition)                                                                                        \
    if (rt_subgroup_ballot(condition) == 0u) break;
#else
#define RT_TEAM_BREAK_UNLESS(condition)
#endif

/* A loop over the chunks of a piece of work, each for one team. Teams claim chunks in order when they are free; *tickets counts
 * them. Where a team is a work-group, each has fixed chunks: PoCL 3.1 loses work-items where a loop with barriers is left from
 * its middle. */
#if RT_CPU || defined(RT_HAS_SUBGROUPS)
RT_INLINE uint rt_team_ticket(volatile global uint *tickets, local uint *scratch)
{
    uint ticket = 0u;
    if (rt_team_item() == 0u) ticket = atomic_inc(tickets);
    return rt_team_broadcast(ticket, scratch);
}
#define RT_FOR_CHUNKS(chunk, chunks, tickets, scratch)                                                                         \
    for (uint chunk; (chunk = rt_team_ticket(tickets, scratch)) < (chunks);)
#else
#define RT_FOR_CHUNKS(chunk, chunks, tickets, scratch)                                                                         \
    for (uint chunk = (uint)get_group_id(0); chunk < (chunks); chunk += (uint)get_num_groups(0))
#endif

/* Claims `amount` elements of an array for the team, from its next free element *next on. Returns the first of them. They may
 * lie beyond the array's end. */
RT_INLINE uint rt_team_claim(volatile global uint *next, uint amount, local uint *scratch)
{
    uint first = 0u;
    if (rt_team_item() == 0u && amount != 0u) first = atomic_add(next, amount);
    return rt_team_broadcast(first, scratch);
}

#endif
