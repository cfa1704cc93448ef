/* loaded_prim.h -- a primitive's record in registers.
 *
 * A traversal of single rays may load primitives by itself, at the same time as nodes. Then the work-items of a warp wait for
 * memory once, and not once for nodes and once for primitives. */
#ifndef RT_LOADED_PRIM_H
#define RT_LOADED_PRIM_H
#if RT_LANES == 1

/* An rt_packed_prim as three 16-byte loads return it. */
typedef struct rt_loaded_prim {
    float4 a, b, c;
} rt_loaded_prim;

RT_INLINE rt_loaded_prim rt_load_leaf(const global rt_packed_prim *leaf)
{
    const global float4 *quads = (const global float4 *)leaf;
    rt_loaded_prim loaded;
    loaded.a = quads[0];
    loaded.b = quads[1];
    loaded.c = quads[2];
    return loaded;
}

#endif
#endif
