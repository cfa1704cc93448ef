/* my_accel_types.h -- what the builder writes and the traversal reads: one page for C++ and OpenCL C. */
#ifndef MY_ACCEL_TYPES_H
#define MY_ACCEL_TYPES_H
/* A box over a run of primitives, which lie side by side in leaf order. 32 B. */
typedef struct my_accel_block {
    rt_f32 box[6]; /* lo.xyz, hi.xyz in the group's space */
    rt_u32 first, count;
} my_accel_block;
/* The blocks of one group. Slot 0, so that a group's root is its number here. 8 B. */
typedef struct my_accel_run {
    rt_u32 first, count;
} my_accel_run;
#endif
