/* loaded_leaf.h -- a primitive's record in registers: what a traversal of single rays fetches by itself, together with nodes, so
 * that the lanes of a warp wait for memory once and not once for each kind. */
#ifndef RT_LOADED_LEAF_H
#define RT_LOADED_LEAF_H
#if RT_LANES == 1

/* An rt_leaf as three 16-byte loads bring it. */
typedef struct rt_loaded_leaf {
    float4 a, b, c;
} rt_loaded_leaf;

RT_INLINE rt_loaded_leaf rt_load_leaf(const global rt_leaf *leaf)
{
    const global float4 *quads = (const global float4 *)leaf;
    rt_loaded_leaf loaded;
    loaded.a = quads[0];
    loaded.b = quads[1];
    loaded.c = quads[2];
    return loaded;
}

#endif
#endif
