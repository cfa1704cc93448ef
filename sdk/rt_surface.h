/* rt_surface.h -- the extension `surface_draft`: a model of surfaces for the tracer `path`, one ray at a time. It is a draft: each change
 * raises RT_SURFACE_VERSION, and a host takes its own version only.
 *
 * Such a plugin is no accel, importer or primitive. It has an rt_extension with the name RT_SURFACE and an rt_surface as data. Its id becomes a word of the key `model` of materials, and its keys become keys of materials with that model.
 *
 * Its kernel file has three functions in OpenCL C, with the plugin's id in front. Directions are unit vectors away from the surface,
 * in the frame of its shading normal, z; wo.z > 0 and wi.z > 0. numbers: the values of its keys, in their order. color: the material's
 * `color` with its textures.
 *     float3 <id>_eval(const global float *numbers, float3 color, float3 wo, float3 wi)       f, without a cosine, 1/sr
 *     float <id>_pdf(const global float *numbers, float3 color, float3 wo, float3 wi)         density of <id>_sample, 1/sr
 *     rt_surface_draw <id>_sample(const global float *numbers, float3 color, float3 wo, float3 u)  u: independent, in [0, 1)
 * docs/surfaces.md says how to write one, and what the draft lacks. */
#ifndef RT_SURFACE_H
#define RT_SURFACE_H
#include <string.h>

#include "rt_plugin.h"

#define RT_SURFACE "surface_draft"
#define RT_SURFACE_VERSION 1u
#define RT_SURFACE_NUMBERS 16u /* of all keys, at most */

#ifdef __cplusplus
extern "C" {
#endif

/* A key of materials with this model. 80 B in this draft. */
typedef struct rt_surface_key {
    const char *name, *label; /* "sigma": [a-z][a-z0-9_]*, no key of all materials; "Slopes": in the window */
    const char *unit, *help;  /* "degrees", or NULL; "standard deviation of the slopes of facets" */
    rt_u32 kind, pad;         /* RT_KEY_NUMBER or RT_KEY_COLOR */
    double min, max;          /* of each number */
    double def[3];
} rt_surface_key;

typedef struct rt_surface {
    rt_u32 struct_bytes, key_count;
    const rt_surface_key *keys;
    rt_cl_file kernels; /* <id>.cl */
} rt_surface;

/* The model of a plugin; NULL: it is another kind of plugin. */
static inline const rt_surface *rt_surface_of(const rt_plugin *plugin)
{
    const rt_extension *e;
    if (plugin->accel || plugin->importer || plugin->primitive) return NULL;
    for (e = plugin->extensions; e && e->name; ++e)
        if (strcmp(e->name, RT_SURFACE) == 0 && e->version == RT_SURFACE_VERSION && e->data_bytes == sizeof(rt_surface))
            return (const rt_surface *)e->data;
    return NULL;
}

#ifdef __cplusplus
}
#endif
#endif
