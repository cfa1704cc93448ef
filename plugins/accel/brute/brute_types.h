/* brute_types.h -- a run of primitives in leaf order. Shared by builder and traversal. */
#ifndef BRUTE_TYPES_H
#define BRUTE_TYPES_H
/* One per group. 8 B. */
typedef struct brute_run {
    rt_u32 first, count;
} brute_run;

#ifdef RT_STEP_BUDGET
typedef struct rt_requeue_scratch {
    uint nearest; /* any hit: 0 once there is one */
} rt_requeue_scratch;
#endif
#endif
