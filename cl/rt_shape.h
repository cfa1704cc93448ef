/* rt_shape.h -- a shape's part as kernels see it. Shared by host and kernels, as rt_types.h; only scenes with shapes include it. */
#ifndef RT_SHAPE_H
#define RT_SHAPE_H

/* 112 B. */
typedef struct rt_shape {
    rt_f32 object_from_world[12]; /* row-major 3x4 */
    rt_f32 numbers[12];           /* of the plugin: RT_SHAPE_NUMBERS */
    rt_u32 kind;                  /* which plugin */
    rt_u32 first_more;            /* further numbers of the plugin begin here in shape_numbers */
    rt_f32 error;                 /* of a point's height above the surface, in object space, as tests of usual exactness have it */
    rt_u32 pad;
} rt_shape;
#endif
