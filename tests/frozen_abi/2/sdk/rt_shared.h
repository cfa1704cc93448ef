/* rt_shared.h -- as it was when version 2 was frozen, without its comments. */
#ifndef RT_SHARED_H
#define RT_SHARED_H
#ifdef __OPENCL_VERSION__
typedef uint rt_u32;
typedef int rt_i32;
typedef float rt_f32;
#else
#include <stdint.h>
typedef uint32_t rt_u32;
typedef int32_t rt_i32;
typedef float rt_f32;
#endif
#define RT_NONE 0xFFFFFFFFu
#define RT_REF_TRIANGLE 0x00000000u
#define RT_REF_SPHERE 0x10000000u
#define RT_REF_POLYGON 0x20000000u
#define RT_REF_INSTANCE 0x30000000u
#define RT_REF_KIND(r) ((r)&0xF0000000u)
#define RT_REF_INDEX(r) ((r)&0x0FFFFFFFu)
#define RT_REF_INDEX_MAX 0x0FFFFFFFu
typedef struct rt_packed_prim {
    rt_f32 a[3];
    rt_u32 ref;
    rt_f32 b[3];
    rt_u32 material;
    rt_f32 c[3];
    rt_u32 prim;
} rt_packed_prim;
#define RT_LIGHT_POINT 0u
#define RT_LIGHT_DIRECTIONAL 1u
#define RT_MATERIAL_CHECKER 1u
#endif
