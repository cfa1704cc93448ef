/* my_accel_types.h -- the structs which the builder writes and the traversal reads, for C++ and OpenCL C. */
#ifndef MY_ACCEL_TYPES_H
#define MY_ACCEL_TYPES_H
/* A box around consecutive primitives in leaf order. 32 bytes. */
typedef struct my_accel_block {
    rt_f32 box[6]; /* lo.xyz, hi.xyz, in the group's space */
    rt_u32 first, count;
} my_accel_block;
/* The range of blocks of one group. It is slot 0, so the root of a group is the index of its range. 8 bytes. */
typedef struct my_accel_run {
    rt_u32 first, count;
} my_accel_run;
#endif
