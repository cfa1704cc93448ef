/* linear_types.h -- a run of primitives in leaf order, all that a list needs. Shared by builder and traversal. */
#ifndef LINEAR_TYPES_H
#define LINEAR_TYPES_H
/* One per group. 8 B. */
typedef struct linear_run {
    rt_u32 first, count;
} linear_run;
#endif
