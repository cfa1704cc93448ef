/* rt_plugin.h -- the plugin ABI. A plugin may include this file and rt_types.h. C99 and C++17.
 *
 * A plugin is one shared library that exports one symbol, the *data* `rt_plugin_v1`. The host checks abi_version, sizes and
 * types_digest there before it runs any code of the plugin. Strings are UTF-8 and live as long as the library, which is never
 * unloaded. Plugins keep no state: they write all results into memory of the host, and pointers that the host passes to them are
 * valid during the call only. No C++ type, exception or allocator crosses this interface (rt_plugin.hpp wraps calls for C++).
 *
 * Growth: structs grow at the end only and hold their size. A reader tests struct_bytes before it reads a field that was added.
 * Any other change increases RT_ABI_VERSION.
 * Version history:
 *   1  First release.
 *   2  Draft: it may still change without a new number, until a release freezes it. What a structure can do is data in rt_accel
 *      (capabilities, merit_cpu, merit_gpu, ray_cost). Version 1 found it as #defines in the text of <id>_types.h. */
#ifndef RT_PLUGIN_H
#define RT_PLUGIN_H
#include "rt_types.h"
#define RT_ABI_VERSION 2u
#ifdef _WIN32
#define RT_EXPORT __declspec(dllexport)
#else
#define RT_EXPORT __attribute__((visibility("default")))
#endif
#ifdef __cplusplus
extern "C" {
#endif

enum { RT_OK = 0, RT_FAILED = 1, RT_CANCELLED = 2 };
enum { RT_LOG_DEBUG, RT_LOG_INFO, RT_LOG_WARNING };

/* Services of the host; valid during the call that received them. All may be called from any thread of parallel_for. On all these
 * threads builders run with the default floating-point mode: denormal numbers are not flushed to zero. */
typedef struct rt_host {
    rt_u32 struct_bytes;
    void *ctx;
    int32_t (*fail)(void *ctx, const char *why); /* keeps the first reason and returns RT_FAILED: `return host->fail(..)` */
    void (*log)(void *ctx, int32_t level, const char *text);
    int32_t (*progress)(void *ctx, float fraction); /* 0..1; returns 0 if the user cancelled: then return RT_CANCELLED soon */
    void (*parallel_for)(void *ctx, rt_u32 count, void (*body)(void *user, rt_u32 i), void *user); /* on all cores; may be nested */
} rt_host;

enum { RT_PARAM_INT, RT_PARAM_FLOAT, RT_PARAM_BOOL, RT_PARAM_ENUM };
enum { RT_EFFECT_REBUILD, RT_EFFECT_RECOMPILE }; /* what the host must do when a parameter changes */
/* A parameter is data: the host draws its widget, parses `--accel bvh2,max_leaf=4`, stores it in presets and checks its range. */
typedef struct rt_param {
    const char *key, *label, *help; /* "max_leaf", "Max leaf size", "primitives in a leaf, at most" (with the unit) */
    int32_t kind, effect;
    double min, max, def;
    const char *const *choices; /* RT_PARAM_ENUM only, NULL-terminated; the value is the index */
} rt_param;

/* ---- acceleration structures -------------------------------------------------------------------------------------------- */

/* A primitive as builders see it: its bounds and an opaque ref. 32 B. */
typedef struct rt_prim {
    float lo[3];
    rt_u32 ref;
    float hi[3];
    rt_u32 mesh; /* number of the placed mesh that it belongs to; primitives of one mesh are contiguous within a group */
} rt_prim;
typedef struct rt_group {
    rt_u32 first, count; /* range of prims; may be empty */
} rt_group;

/* Geometry, for builders that split or pack primitives. triangles[i] holds the corners a, b, c of the triangle with ref i, in the
 * space of its group. */
typedef struct rt_geometry {
    rt_u32 struct_bytes;
    const rt_packed_prim *triangles;
    uint64_t triangle_count;
} rt_geometry;

typedef struct rt_build_input {
    rt_u32 struct_bytes, group_count;
    const rt_prim *prims;
    const rt_group *groups; /* [0]: the world, refs of any kind. [1..]: one instanced mesh each, in its own space, no instances */
    const rt_geometry *geometry;
    const double *params; /* in the order of rt_plugin::params */
} rt_build_input;

typedef struct rt_build_output {
    rt_u32 struct_bytes;
    void *ctx;
    /* Returns zeroed, 128-byte aligned memory of the host for `count` elements of a slot. Call it once for each slot. After NULL,
     * stop and return RT_FAILED. */
    void *(*alloc)(void *ctx, rt_u32 slot, uint64_t count);
    /* Returns memory of the host for `count` refs in leaf order. Call it once. The host packs the primitives in this order, and
     * RT_LEAF takes a position in it. A ref may occur several times (spatial splits). After NULL, stop and return RT_FAILED. */
    rt_u32 *(*leaves)(void *ctx, uint64_t count);
    void (*root)(void *ctx, rt_u32 group, rt_u32 node); /* node: an element of slot 0. Call it for every group, also empty ones */
    void (*define)(void *ctx, const char *name, rt_u32 value); /* a kernel's macro, BVH2_STACK; round up: a new value recompiles */
    void (*stat)(void *ctx, const char *label, double value); /* "nodes", "depth", "sah_cost": for panel, --stats and bench */
} rt_build_output;

/* A slot becomes a kernel argument and the member `name` of rt_ctx: `const global <cl_type> *<name>`. */
typedef struct rt_slot {
    const char *name, *cl_type;
    rt_u32 elem_bytes; /* compared with sizeof(cl_type) on the device */
} rt_slot;
typedef struct rt_cl_file {
    const char *name, *text; /* "bvh2.cl"; in development the host reads the file from disk, else it takes the embedded text */
} rt_cl_file;

/* A finished structure, read-only, for `levels`. */
typedef struct rt_built {
    rt_u32 struct_bytes, group_count;
    const void *const *slots;    /* slot_count pointers */
    const uint64_t *slot_counts; /* elements */
    const rt_u32 *roots;         /* one per group */
} rt_built;
#define RT_LEVEL_BOTTOM 0xFFFFFFFFu
typedef struct rt_volume_sink {
    rt_u32 struct_bytes;
    void *ctx;
    void (*box)(void *ctx, const float lo[3], const float hi[3]);
    void (*sphere)(void *ctx, const float center[3], float radius);
} rt_volume_sink;

/* What a traversal offers besides RT_TRAVERSE, as bits of rt_accel::capabilities; cl/CONTRACT.md describes each. The host defines
 * the names of those that are set in the structure's kernels. It ignores bits that it does not know. */
enum {
    RT_TRAVERSES_STREAMS = 1,  /* RT_TRAVERSE_STREAM: traces neighbouring packets together, on CPUs */
    RT_TRAVERSES_STEPS = 2,    /* RT_TRAVERSE_step: traces step by step, so that a work-item may fetch another ray, on GPUs */
    RT_TRAVERSES_WARPS = 4,    /* RT_TRAVERSE_WARP: all rays of a warp visit the same nodes, on GPUs */
    RT_REQUEUES_LONG_RAYS = 8, /* RT_TRAVERSE_REQUEUED: many work-items trace one long ray, on GPUs */
    RT_SPLITS_INCOHERENT = 16  /* reads ray->incoherent: traces incoherent packets ray by ray, on CPUs */
};
/* How the time of a ray grows with the number n of primitives: like log n, as with trees, or like n. Tests and benches leave out
 * structures of linear cost where a scene is large. */
enum { RT_RAY_COST_LOGARITHMIC, RT_RAY_COST_LINEAR };

typedef struct rt_accel {
    rt_u32 struct_bytes, slot_count;
    const rt_slot *slots;
    rt_cl_file types;    /* structs shared with the builder; text may be NULL */
    rt_cl_file traverse; /* see cl/CONTRACT.md */
    int32_t (*build)(const rt_host *, const rt_build_input *, const rt_build_output *); /* [worker thread] */
    /* Bounding volumes of level n of one group's tree (0 = root, RT_LEVEL_BOTTOM = leaves), in the group's space. [any thread] */
    int32_t (*levels)(const rt_host *, const rt_built *, rt_u32 group, rt_u32 level, const rt_volume_sink *); /* or NULL */
    int32_t (*refit)(const rt_host *, const rt_build_input *, void *const *slot_data);                       /* or NULL */
    /* Since version 2. */
    rt_u32 capabilities;        /* RT_TRAVERSES_STREAMS, ...: bits */
    float merit_cpu, merit_gpu; /* primary and diffuse rays a second over usual scenes, divided by those of Clarity's binary BVH
                                 * on a device of that kind; 0: not measured. If the user names no structure, the host takes the
                                 * one of the highest merit. Among equal ones it takes the first by id. */
    rt_u32 ray_cost;            /* RT_RAY_COST_LOGARITHMIC or RT_RAY_COST_LINEAR */
} rt_accel;

/* ---- importers ------------------------------------------------------------------------------------------------------------ */

/* Strides are in bytes. The host copies all data before the call returns. Faces may have any number of corners. The host
 * triangulates them in order: flat convex ones as a fan from the first corner, bent or concave ones as scene/triangulate.hpp says.
 * It drops faces of fewer than three corners. */
typedef struct rt_mesh {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    const float *positions;
    rt_u32 vertex_count, position_stride;
    const float *normals; /* per vertex, or NULL */
    rt_u32 normal_stride;
    const float *uvs; /* per vertex, (0,0) at the bottom left; or NULL */
    rt_u32 uv_stride;
    const rt_u32 *indices; /* corners of all faces, one after the other */
    uint64_t index_count;
    const rt_u32 *face_sizes; /* corners of each face; NULL: all triangles */
    uint64_t face_count;
    const rt_u32 *face_materials; /* per face, ids that the sink's `material` returned; NULL: all have `material` */
    rt_u32 material;              /* RT_NONE: the default material */
} rt_mesh;

typedef struct rt_instance_desc {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    rt_u32 mesh;      /* id that the sink's `mesh` returned */
    rt_u32 material;  /* for the whole instance; RT_NONE: the mesh's own */
    float world_from_object[12]; /* row-major 3x4 */
} rt_instance_desc;

typedef struct rt_material_desc {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    rt_material values; /* .texture: an id that the sink's `texture` returned, or RT_NONE */
} rt_material_desc;

typedef struct rt_texture_desc {
    rt_u32 struct_bytes;
    const char *path;           /* relative to the file being imported; NULL: the image is in `bytes` */
    const uint8_t *bytes;       /* encoded (PNG, JPEG, ...) if height is 0, else width x height RGBA8 */
    uint64_t byte_count;
    rt_u32 width, height;
} rt_texture_desc;

typedef struct rt_camera {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    float eye[3], target[3], up[3];
    float fov_y_rad;
} rt_camera;

typedef struct rt_light_desc {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    rt_light values;
} rt_light_desc;

typedef struct rt_load {
    rt_u32 struct_bytes;
    const char *path;            /* relative to the file being imported */
    const char *name;            /* or NULL */
    float world_from_object[12]; /* applied after the file's own transforms */
    rt_u32 material;             /* for all of it, or RT_NONE */
    const char *where;           /* place that names the file, for error messages: "main.scene:3:9"; or NULL */
} rt_load;

typedef struct rt_scene_info {
    rt_u32 struct_bytes;
    rt_u32 up_axis;    /* 0 X, 1 Y, 2 Z, as the file says; geometry is passed in the file's own axes */
    double unit_scale; /* metres per unit of the file, as the file says; 0: it does not say */
    const float *background; /* linear RGB, or NULL: the file does not say */
    const float *ambient;    /* linear RGB, or NULL */
} rt_scene_info;

/* Calls that return an id copy their arguments. RT_NONE means that they failed and recorded the error: then return RT_FAILED. */
typedef struct rt_scene_sink {
    rt_u32 struct_bytes;
    void *ctx;
    rt_u32 (*texture)(void *ctx, const rt_texture_desc *); /* a missing or broken image is a warning: RT_NONE is no error here */
    rt_u32 (*material)(void *ctx, const rt_material_desc *);
    rt_u32 (*mesh)(void *ctx, const rt_mesh *);
    rt_u32 (*instance)(void *ctx, const rt_instance_desc *);
    rt_u32 (*sphere)(void *ctx, const float center[3], float radius, rt_u32 material);
    rt_u32 (*plane)(void *ctx, const float normal[3], float offset, rt_u32 material);
    rt_u32 (*polygon)(void *ctx, const float *corners, rt_u32 corner_count, rt_u32 material); /* planar, 3 floats a corner */
    rt_u32 (*light)(void *ctx, const rt_light_desc *);
    rt_u32 (*camera)(void *ctx, const rt_camera *);
    void (*info)(void *ctx, const rt_scene_info *);
    void (*warn)(void *ctx, const char *text);         /* shown to the user, in `info` as warnings[] */
    int32_t (*load)(void *ctx, const rt_load *);       /* imports another file; RT_OK, or RT_FAILED with the error recorded */
} rt_scene_sink;

typedef struct rt_importer {
    rt_u32 struct_bytes;
    const char *const *extensions; /* lower case, no dot, NULL-terminated */
    int32_t (*probe)(const uint8_t *head, uint64_t bytes); /* 0..100 certainty by the first bytes; or NULL: extension only */
    int32_t (*load)(const rt_host *, const char *path, const double *params, const rt_scene_sink *);
} rt_importer;

typedef struct rt_plugin {
    rt_u32 abi_version, struct_bytes, types_digest, param_count; /* first in every version */
    const char *id, *name, *version, *reference; /* id: [a-z][a-z0-9_]*, also the prefix of its CL names; reference: paper, or NULL */
    const rt_param *params;
    const rt_accel *accel; /* exactly one of the two is not NULL */
    const rt_importer *importer;
} rt_plugin;

RT_EXPORT extern const rt_plugin rt_plugin_v1; /* the only exported symbol; data, not code */
#ifdef __cplusplus
}
#endif
#endif
