/* rt_plugin.h -- the plugin ABI, version 2, frozen. A plugin may include this file and rt_shared.h. C99 and C++17, 64-bit machines.
 *
 * A plugin is one shared library that exports one symbol, the *data* `rt_plugin_v1`. The host checks abi_version, sizes and
 * types_digest there before it runs any code of the plugin. Strings are UTF-8 and live as long as the library, which is never
 * unloaded. Plugins keep no state: they write all results into memory of the host, and pointers that the host passes to them are
 * valid during the call only. No C++ type, exception or allocator crosses this interface (rt_plugin.hpp wraps calls for C++).
 *
 * The promise: a plugin that was built with this file loads into every later host that speaks version 2, and a plugin that was
 * built with a later version-2 file loads into this host. For that, only the following may change within version 2:
 * - Fields are appended to structs that begin with struct_bytes, and to the elements of arrays whose size is told (rt_param,
 *   rt_slot, rt_extension). Such a struct never has padding at its end. What is in it today keeps its place, type and meaning.
 * - A field that a plugin does not have reads as zero in the host: the host copies what is there into a zeroed struct of its own.
 *   So 0 in an appended field means "as before". A host accepts every struct that has at least the fields of the first release.
 * - A struct that the host passes may be shorter, or longer, than in the plugin's header. A plugin tests with RT_HAS whether a field
 *   is there, if that field is younger than version 2. All other fields of this file are always there.
 * - Enums get further values and bit masks further bits. A host refuses a kind that it does not know, and ignores other bits.
 * - Anything larger is an rt_extension: it has a name and a version of its own.
 * The other structs (rt_packed_prim, rt_prim, rt_group, rt_topology_node, rt_cl_file, rt_key_values, rt_layer, rt_bone, rt_weight,
 * rt_morph_target) never change: data beside theirs would come in arrays of their own. Kernels have a version of their own, RT_KERNEL_CONTRACT. Any other change increases RT_ABI_VERSION.
 *
 * Version history:
 *   1  First release. Hosts of later versions do not load it.
 *   2  Structs and arrays that can grow. What a structure can do is data. The kernel contract has a number. Materials and lights
 *      are described in structs of this file. A plugin may build only a tree and leave its layout to another plugin.
 *      Appended: shapes (rt_plugin::primitive; primitive_kind and primitive of rt_scene_sink); motion (node, clip, channel, skin,
 *      morph and vertex_frames of rt_scene_sink; `node` of instances, cameras, lights and loads); edit of rt_scene_sink; wrap_u and
 *      wrap_v of textures; aperture and focus of cameras; content of rt_host, flags of rt_importer; sky and sky_kind of
 *      rt_scene_sink, faces and turn of skies; colors, uvs2 and tangents of meshes; space and filter of textures; maps of
 *      materials; RT_TRAVERSES_SINGLE_RAYS. */
#ifndef RT_PLUGIN_H
#define RT_PLUGIN_H
#include <stddef.h>

#include "rt_shared.h"
#define RT_ABI_VERSION 2u
/* Version of what a traversal may use and must promise (CONTRACT.md). A later contract with this number only adds names. */
#define RT_KERNEL_CONTRACT 1u
#ifdef _WIN32
#define RT_EXPORT __declspec(dllexport)
#else
#define RT_EXPORT __attribute__((visibility("default")))
#endif
#ifdef __cplusplus
extern "C" {
#endif

/* Whether a struct that the host passed has a field: RT_HAS(in, rt_build_input, device). */
#define RT_HAS(pointer, type, field) ((pointer)->struct_bytes >= offsetof(type, field) + sizeof((pointer)->field))

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
    /* appended: for importers with RT_IMPORTER_TAKES_CONTENT. The bytes of the file `path` of `load`, which may not be on disk under
     * that name, because it is packed there (bunny.ply.gz). NULL: read the file. */
    const uint8_t *content;
    uint64_t content_bytes;
} rt_host;

enum { RT_PARAM_INT, RT_PARAM_FLOAT, RT_PARAM_BOOL, RT_PARAM_ENUM };
enum { RT_EFFECT_REBUILD, RT_EFFECT_RECOMPILE }; /* what the host must do when a parameter changes */
/* A parameter is data: the host draws its widget, parses `--accel bvh2,max_leaf=4`, stores it in presets and checks its range.
 * rt_plugin::param_bytes tells the size of an element. */
typedef struct rt_param {
    const char *key, *label, *help; /* "max_leaf", "Max leaf size", "primitives in a leaf, at most" (with the unit) */
    int32_t kind, effect;
    double min, max, def;
    const char *const *choices; /* RT_PARAM_ENUM only, NULL-terminated; the value is the index */
} rt_param;

/* ---- acceleration structures -------------------------------------------------------------------------------------------- */

/* A primitive as builders see it: its bounds and an opaque ref. 32 B; it never grows. */
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

enum { RT_DEVICE_UNKNOWN, RT_DEVICE_CPU, RT_DEVICE_GPU };
/* The device for which a structure is built. It is advice: the host may trace the same result on another device, so the result must
 * be right everywhere. 0: not known. */
typedef struct rt_device {
    rt_u32 struct_bytes;
    rt_u32 kind;             /* RT_DEVICE_... */
    rt_u32 lanes;            /* rays that a work-item traces together: RT_LANES in kernels */
    rt_u32 compute_units;    /* cores of a CPU, multiprocessors of a GPU */
    rt_u32 cache_line_bytes;
    rt_u32 local_bytes;      /* local memory of a work-group */
    uint64_t unit_cache_bytes;   /* the largest cache that a core has for itself */
    uint64_t shared_cache_bytes; /* the largest cache that the device's units share */
    uint64_t memory_bytes;
} rt_device;

typedef struct rt_build_input {
    rt_u32 struct_bytes, group_count;
    const rt_prim *prims;
    const rt_group *groups; /* [0]: the world, refs of any kind. [1..]: one instanced mesh each, in its own space, no instances */
    const rt_geometry *geometry;
    const double *params;    /* in the order of rt_plugin::params */
    const rt_device *device; /* never NULL */
    /* Some groups only. NULL: build all groups; first_elements is NULL then, too. Otherwise group g is built if wanted[g] is not 0,
     * and the others have neither root, nodes nor leaves in the output. The host appends the result to other parts of the same
     * structure. So every index into slot s that the builder writes or reports as a root counts from first_elements[s], and every
     * position in leaf order from first_leaf. Where parts define different values, kernels get the greatest. Reserved: no host
     * asks for it yet, and it would ask only structures with RT_BUILDS_GROUPS. */
    const uint8_t *wanted;
    const uint64_t *first_elements;
    uint64_t first_leaf;
} rt_build_input;

typedef struct rt_build_output {
    rt_u32 struct_bytes;
    void *ctx;
    /* Returns zeroed, 128-byte aligned memory of the host for `count` elements of a slot. Call it once for each slot. After NULL,
     * stop and return RT_FAILED. */
    void *(*alloc)(void *ctx, rt_u32 slot, uint64_t count);
    /* Returns memory of the host for `count` refs in leaf order. Call it once. The host packs the primitives in this order, and
     * RT_LEAF takes a position in it. A ref may occur several times (spatial splits); each time costs a packed primitive of 48 B.
     * Where many leaves name the same primitive, as in grids and kd-trees, give each ref once, and keep lists of positions in a
     * slot of `uint`. After NULL, stop and return RT_FAILED. */
    rt_u32 *(*leaves)(void *ctx, uint64_t count);
    void (*root)(void *ctx, rt_u32 group, rt_u32 node); /* node: an element of slot 0. Call it for every group, also empty ones */
    void (*define)(void *ctx, const char *name, rt_u32 value); /* a kernel's macro, BVH2_STACK; round up: a new value recompiles */
    void (*stat)(void *ctx, const char *label, double value); /* "nodes", "depth", "sah_cost": for panel, --stats and bench */
} rt_build_output;

/* A slot becomes a kernel argument and the member `name` of rt_ctx: `const global <cl_type> *<name>`. rt_accel::slot_bytes tells the
 * size of an element. */
#define RT_SLOT_HOST_ONLY 1u /* for `levels` and the host: it is not sent to a device, and kernels have no such member */
typedef struct rt_slot {
    const char *name, *cl_type; /* cl_type: NULL with RT_SLOT_HOST_ONLY */
    rt_u32 elem_bytes;          /* compared with sizeof(cl_type) on the device */
    rt_u32 flags;               /* RT_SLOT_...; slot 0 has none, because roots are elements of it */
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
    /* Appended: ask RT_HAS first. halves: three vectors from the centre to the middles of three sides. */
    void (*oriented_box)(void *ctx, const float center[3], const float halves[9]);
} rt_volume_sink;

/* A node of a binary tree over the primitives of one group. 32 B; it never grows. */
typedef struct rt_topology_node {
    float lo[3];
    rt_u32 left; /* inner node: index of a child. Leaf: position of its first ref */
    float hi[3];
    rt_u32 right; /* inner node: index of the other child. Leaf: RT_TOPOLOGY_LEAF | number of its refs, 1 or more */
} rt_topology_node;
#define RT_TOPOLOGY_LEAF 0x80000000u
#define RT_TOPOLOGY_DEPTH 256u /* nodes on the way from a root to a leaf, at most */

/* Receives a topology. Call nodes and refs once each; after NULL, stop and return RT_FAILED. */
typedef struct rt_topology_output {
    rt_u32 struct_bytes;
    void *ctx;
    rt_topology_node *(*nodes)(void *ctx, uint64_t count); /* zeroed; the host ignores nodes that no root reaches */
    rt_u32 *(*refs)(void *ctx, uint64_t count);            /* in the order in which leaves name them; a ref may occur several times */
    void (*root)(void *ctx, rt_u32 group, rt_u32 node);    /* RT_NONE: the group is empty */
    void (*stat)(void *ctx, const char *label, double value);
} rt_topology_output;

/* A finished topology. The host has checked it: each root has a tree of its own, at most RT_TOPOLOGY_DEPTH deep, whose leaves name
 * known refs. Boxes are the builder's, unchecked. */
typedef struct rt_topology {
    rt_u32 struct_bytes, group_count;
    const rt_topology_node *nodes;
    uint64_t node_count;
    const rt_u32 *refs;
    uint64_t ref_count;
    const rt_u32 *roots; /* a node for each group, or RT_NONE: the group is empty */
} rt_topology;

/* What a structure offers besides RT_TRAVERSE and `build`, as bits of rt_accel::capabilities; cl/CONTRACT.md describes those of
 * kernels. The host defines the names of those that are set in the structure's kernels. It ignores bits that it does not know. */
enum {
    RT_TRAVERSES_STREAMS = 1,  /* RT_TRAVERSE_STREAM: traces neighbouring packets together, on CPUs */
    RT_TRAVERSES_STEPS = 2,    /* RT_TRAVERSE_step: traces step by step, so that a work-item may fetch another ray, on GPUs */
    RT_TRAVERSES_WARPS = 4,    /* RT_TRAVERSE_WARP: all rays of a warp visit the same nodes, on GPUs */
    RT_REQUEUES_LONG_RAYS = 8, /* RT_TRAVERSE_REQUEUED: many work-items trace one long ray, on GPUs */
    RT_SPLITS_INCOHERENT = 16, /* reads ray->incoherent: traces incoherent packets ray by ray, on CPUs */
    RT_BUILDS_GROUPS = 32,     /* reserved: `build` obeys rt_build_input::wanted */
    RT_TRAVERSES_SINGLE_RAYS = 64 /* appended: RT_TRAVERSE traces one ray, and the host spreads packets over it, on CPUs */
};
/* How the time of a ray grows with the number n of primitives: like log n, as with trees, or like n. Tests and benches leave out
 * structures of linear cost where a scene is large. */
enum { RT_RAY_COST_LOGARITHMIC, RT_RAY_COST_LINEAR };

/* There are two kinds of structures:
 * - One with slots and a traversal of its own. It has `build`, and may have `levels` and `pack`. `layout` and `topology` are NULL.
 * - One that builds only the topology of a binary tree. It has `layout` and `topology`. Another structure, the layout, packs that
 *   tree into its own nodes and traces it. All other pointers, slot_count, kernel_contract and capabilities are 0. */
typedef struct rt_accel {
    rt_u32 struct_bytes;
    rt_u32 kernel_contract; /* RT_KERNEL_CONTRACT: the version for which types and traverse were written */
    rt_u32 slot_count, slot_bytes; /* slot_bytes: sizeof(rt_slot) */
    const rt_slot *slots;
    rt_cl_file types;    /* structs shared with the builder; text may be NULL */
    rt_cl_file traverse; /* see cl/CONTRACT.md */
    int32_t (*build)(const rt_host *, const rt_build_input *, const rt_build_output *); /* [worker thread] */
    /* Bounding volumes of level n of one group's tree (0 = root, RT_LEVEL_BOTTOM = leaves), in the group's space. [any thread] */
    int32_t (*levels)(const rt_host *, const rt_built *, rt_u32 group, rt_u32 level, const rt_volume_sink *); /* or NULL */
    /* Fills the slots with the tree that another plugin built, instead of `build`. `params` of the input are this plugin's own, at
     * their defaults. Leaves may be split, but not lose a ref. [worker thread] */
    int32_t (*pack)(const rt_host *, const rt_build_input *, const rt_topology *, const rt_build_output *); /* or NULL */
    const char *layout; /* id of a structure that has `pack`: "bvh2"; or NULL */
    /* Builds a binary tree for each group. [worker thread] */
    int32_t (*topology)(const rt_host *, const rt_build_input *, const rt_topology_output *); /* or NULL */
    rt_u32 capabilities;        /* RT_TRAVERSES_STREAMS, ...: bits */
    float merit_cpu, merit_gpu; /* primary and diffuse rays a second over usual scenes, divided by those of Clarity's binary BVH
                                 * on a device of that kind; 0: not measured. If the user names no structure, the host takes the
                                 * one of the highest merit. Among equal ones it takes the first by id. */
    rt_u32 ray_cost;            /* RT_RAY_COST_LOGARITHMIC or RT_RAY_COST_LINEAR */
} rt_accel;

/* ---- shapes --------------------------------------------------------------------------------------------------------------- */

enum {
    RT_KEY_NUMBER, /* one number */
    RT_KEY_WHOLE,  /* one whole number; 0 or 1 for yes and no */
    RT_KEY_POINT,  /* x y z */
    RT_KEY_VECTOR, /* x y z, not all of them 0 */
    RT_KEY_NUMBERS, /* numbers, as many as the file has */
    RT_KEY_POINTS,  /* x y z of each point, as many as the file has */
    /* Of lights and materials alone: */
    RT_KEY_COLOR, /* r g b, or one number for a grey */
    RT_KEY_WORD,  /* one of `words`: its number, from 0 */
    RT_KEY_FLAG,  /* 0 or 1: `true` or `false`; the name alone means `true` */
    RT_KEY_TEXTURE /* the name of a texture; def[0]: its RT_SPACE_ where it says none; `words`: keys that it multiplies */
};
#define RT_KEY_REQUIRED 1u /* the statement must have this key; otherwise numbers default to def, and lists are empty */
/* A key of a statement in text scenes, `radius .5`: of a shape, a light or a material. It is data: importers read the values and
 * write the messages. rt_primitive::key_bytes tells the size of an element. */
typedef struct rt_key {
    const char *name, *help; /* "radius", "distance from the axis": [a-z][a-z0-9_]*, not `material` */
    rt_u32 kind, flags;      /* RT_KEY_NUMBER, ..., RT_KEY_REQUIRED */
    double min, max;         /* of each number */
    double def[3];
    const char *const *words; /* appended: of RT_KEY_WORD and RT_KEY_TEXTURE, NULL-terminated; else NULL */
} rt_key;
/* The value of a key by its name. 24 B; it never grows. */
typedef struct rt_key_value {
    const char *key;  /* "radius" */
    float numbers[3]; /* of a word its number, of a flag 0 or 1 */
    rt_u32 pad;       /* 0 */
} rt_key_value;
/* The values of one key. 16 B; it never grows. */
typedef struct rt_key_values {
    const float *numbers;
    rt_u32 count;
    rt_u32 given; /* 0: the file does not have the key, so these are its defaults */
} rt_key_values;

#define RT_SHAPE_NUMBERS 12u /* of each part of a shape, 48 B, for its kernels */
/* Receives the parts of a shape: each becomes one primitive of the acceleration structure. All have the same number `prim`. */
typedef struct rt_shape_output {
    rt_u32 struct_bytes;
    void *ctx;
    /* lo, hi: box of the part. numbers: RT_SHAPE_NUMBERS at most. more: further numbers for the part's kernels, or NULL. The host
     * copies all of it. */
    int32_t (*part)(void *ctx, const float lo[3], const float hi[3], const float *numbers, rt_u32 count, const float *more,
                    uint64_t more_count); /* RT_OK, or RT_FAILED with the error recorded */
} rt_shape_output;

#define RT_SHAPE_SINGLE_RAY 1u /* its kernels take one ray at a time: `float`, where others have `vfloat` */
/* A shape, in its own space: the host transforms rays, points and normals. At least one of bounds and prepare is not NULL. Both run
 * in the worker process in which the importer runs. values[i] belongs to keys[i], and is within the key's range. */
typedef struct rt_primitive {
    rt_u32 struct_bytes;
    rt_u32 kernel_contract; /* RT_KERNEL_CONTRACT */
    rt_u32 key_count, key_bytes; /* key_bytes: sizeof(rt_key) */
    const rt_key *keys;
    rt_cl_file kernels; /* <id>_hit and <id>_surface: see CONTRACT.md */
    /* The box of the shape. Without `prepare`, the numbers of all keys in their order are those of its kernels. */
    int32_t (*bounds)(const rt_host *, const rt_key_values *values, float lo[3], float hi[3]);
    int32_t (*prepare)(const rt_host *, const rt_key_values *values, const rt_shape_output *); /* or NULL */
    rt_u32 flags;                                                                              /* RT_SHAPE_... */
    rt_u32 pad;                                                                                /* 0 */
} rt_primitive;

/* ---- importers ------------------------------------------------------------------------------------------------------------ */

/* Strides are in bytes. The host copies all data before the call returns. Faces may have any number of corners. The host
 * triangulates them in order: flat convex ones as a fan from the first corner, bent or concave ones as scene/triangulate.hpp says.
 * It drops faces of fewer than three corners. */
typedef struct rt_mesh {
    rt_u32 struct_bytes;
    rt_u32 material;  /* RT_NONE: the default material */
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
    double origin[3]; /* appended: what was subtracted from positions in double precision, so that floats keep their details */
    const float *colors; /* appended: linear r, g, b and alpha per vertex, which multiply the color of the material; or NULL */
    rt_u32 color_stride, pad;
    const float *uvs2;     /* appended: a second set of texture coordinates per vertex, for rt_map_desc::set; or NULL */
    const float *tangents; /* appended: x, y, z along u, and w: 1 or -1 times cross(normal, tangent) is along v; or NULL: they come
                            * from the texture coordinates of the normal map, after Mikkelsen 2008 */
    rt_u32 uv2_stride, tangent_stride;
} rt_mesh;

typedef struct rt_instance_desc {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    rt_u32 mesh;      /* id that the sink's `mesh` returned */
    rt_u32 material;  /* for the whole instance; RT_NONE: the mesh's own */
    float world_from_object[12]; /* row-major 3x4; with a node: from the object into the node's space */
    rt_u32 node;                 /* appended: id of the node that moves it; 0: none */
    rt_u32 pad;                  /* 0 */
    const double *translation;   /* appended: x, y, z, in place of numbers 3, 7 and 11 of world_from_object; NULL: those */
} rt_instance_desc;

/* One use of a texture by a material. rt_material_desc::map_bytes tells the size of an element. rt::map() gives usual values. */
typedef struct rt_map_desc {
    rt_u32 use;      /* RT_MAP_... */
    rt_u32 texture;  /* id that the sink's `texture` returned; RT_NONE: the map is left out */
    rt_u32 set;      /* 0: the mesh's uvs; 1: its uvs2 */
    float scale;     /* RT_MAP_NORMAL: of x and y; RT_MAP_OCCLUSION: its strength; else 1 */
    float matrix[6]; /* 2x3, row-major: from the mesh's coordinates to the texture's. (0, 0) is at the bottom left. All 0: the identity */
} rt_map_desc;

/* A material. The members are those of Whitted's; docs/scene_format.md lists the keys of `values`. Colours are linear RGB. The share 1 - reflect - refract is diffuse. rt::material() gives usual values. */
typedef struct rt_material_desc {
    rt_u32 struct_bytes;
    rt_u32 flags;      /* RT_MATERIAL_CHECKER, or 0 */
    const char *name;  /* or NULL */
    float color[3];    /* diffuse reflectance; also tints refracted light */
    float reflect;     /* 0..1, mirror share */
    float emission[3]; /* light added at each hit */
    float refract;     /* 0..1, share that Fresnel's equations split into reflected and refracted light */
    float specular[3]; /* colour of the Blinn-Phong highlight */
    float shininess;   /* exponent of the highlight */
    float ior;         /* index of refraction of the inside, 1.5 for glass */
    rt_u32 texture;    /* id that the sink's `texture` returned, which multiplies color; RT_NONE: none */
    const rt_key_value *values; /* appended: of keys that rt_scene_sink::material_kind names, which replace the members above; or NULL */
    rt_u32 value_count, pad;
    const rt_map_desc *maps; /* appended: one for each use at most. RT_MAP_COLOR replaces `texture`; or NULL */
    rt_u32 map_count, map_bytes;
} rt_material_desc;

/* What a texture shows outside of its picture, along u or v. */
enum {
    RT_WRAP_REPEAT, /* the picture again */
    RT_WRAP_CLAMP,  /* its border */
    RT_WRAP_MIRROR  /* the picture again, every other time mirrored */
};
enum {
    RT_SPACE_SRGB,   /* r, g and b are colours in sRGB */
    RT_SPACE_LINEAR, /* all channels are numbers */
    RT_SPACE_HEIGHT, /* r is a height, and the host makes a map of normals of it: white stands out of black by a fiftieth of the picture's
                      * width. A picture that is not grey is a map of normals already. For RT_MAP_NORMAL */
    RT_SPACE_ALPHA,    /* appended, for RT_MAP_OPACITY: the host puts the alpha into all channels */
    RT_SPACE_CLEARNESS /* appended, for RT_MAP_OPACITY: the host puts 1 minus the brightness, 0.2127 r + 0.7152 g + 0.0721 b, into all channels */
};
enum { RT_FILTER_SMOOTH, RT_FILTER_NEAREST }; /* between texels */
typedef struct rt_texture_desc {
    rt_u32 struct_bytes;
    const char *path;           /* relative to the file being imported; NULL: the image is in `bytes` */
    const uint8_t *bytes;       /* encoded (PNG, JPEG, ...) if height is 0, else width x height RGBA8 */
    uint64_t byte_count;
    rt_u32 width, height;
    rt_u32 wrap_u, wrap_v; /* appended: RT_WRAP_... */
    rt_u32 space;          /* appended: RT_SPACE_... */
    rt_u32 filter;         /* appended: RT_FILTER_... */
    const char *name;      /* appended: what the file calls it; NULL: the name of its file, if it has one */
} rt_texture_desc;

typedef struct rt_camera {
    rt_u32 struct_bytes;
    const char *name; /* or NULL */
    float eye[3], target[3], up[3]; /* with a node: in the node's space */
    float fov_y_rad;
    rt_u32 node; /* appended: id of the node that moves it; 0: none */
    rt_u32 pad;  /* 0 */
    float aperture; /* appended: diameter of the lens; 0: a pinhole */
    float focus;    /* appended: distance along the view at which the lens is sharp; 0: that of the target */
} rt_camera;

/* A light. With a node, all of it is in the node's space. What has neither a member nor a value is as docs/scene_format.md says:
 * a point light without values has no falloff. */
typedef struct rt_light_desc {
    rt_u32 struct_bytes;
    rt_u32 kind;        /* RT_LIGHT_POINT, ... */
    const char *name;   /* or NULL */
    float position[3];  /* of a point or spot light; the middle of a rect, disc or sphere */
    float direction[3]; /* into which a directional light, a sun or a spot shines; need not be unit */
    float color[3];     /* linear RGB, intensity included */
    rt_u32 pad;         /* 0 */
    rt_u32 node;        /* appended: id of the node that moves it; 0: none */
    rt_u32 pad2;        /* 0 */
    const rt_key_value *values; /* appended: of keys that rt_scene_sink::light_kind names, which replace the members above; or NULL */
    rt_u32 value_count, pad3;
} rt_light_desc;

typedef struct rt_load {
    rt_u32 struct_bytes;
    const char *path;            /* relative to the file being imported */
    const char *name;            /* or NULL */
    float world_from_object[12]; /* applied after the file's own transforms */
    rt_u32 material;             /* for all of it, or RT_NONE */
    const char *where;           /* place that names the file, for error messages: "main.scene:3:9"; or NULL */
    rt_u32 node;                 /* appended: id of a node, into whose space world_from_object leads; 0: none */
    rt_u32 pad;                  /* 0 */
} rt_load;

typedef struct rt_scene_info {
    rt_u32 struct_bytes;
    rt_u32 up_axis;    /* 0 X, 1 Y, 2 Z, as the file says; geometry is passed in the file's own axes */
    double unit_scale; /* metres per unit of the file, as the file says; 0: it does not say */
    const float *background; /* linear RGB, or NULL: the file does not say */
    const float *ambient;    /* linear RGB, or NULL */
} rt_scene_info;

/* A kind of shapes that the sink takes: the plugin's id, and its keys. Likewise a kind of lights, and materials. */
typedef struct rt_primitive_kind {
    rt_u32 struct_bytes, key_count;
    const char *id;
    const rt_key *keys;
    rt_u32 key_bytes, pad;
} rt_primitive_kind;
typedef struct rt_primitive_desc {
    rt_u32 struct_bytes, material;
    const char *kind;            /* id of a kind */
    const rt_key_values *values; /* one for each of its keys, in their order */
    rt_u32 value_count, pad;
    const char *where; /* place that has the shape, for error messages: "main.scene:3:1"; or NULL */
} rt_primitive_desc;

/* Motion. All of it is appended: ask RT_HAS(sink, rt_scene_sink, vertex_frames) first. Importers deliver what the file has, and the
 * host computes the pose of a time from it. Times are seconds on the clip's own clock. Ids of nodes, clips and morphs count from 1.
 * Matrices are row-major 3x4. What a node without parent moves is in the file's space. */

enum { RT_ROTATE_XYZ, RT_ROTATE_XZY, RT_ROTATE_YZX, RT_ROTATE_YXZ, RT_ROTATE_ZXY, RT_ROTATE_ZYX, RT_ROTATE_QUATERNION };
/* How a node takes over its parent's scale. R, S: rotation and scale of the parent's transform in the world, its translation left
 * out; r, s: the node's own; p: the parent's own scale. Names as in FBX. */
enum {
    RT_INHERIT_RSRS, /* R S r s: products of matrices, as everywhere else */
    RT_INHERIT_RRSS, /* R r S s: the parent's scale acts along the node's own axes */
    RT_INHERIT_RRS   /* R r (S without p) s: the parent's own scale is left out */
};
#define RT_NODE_HIDDEN 1u         /* what it and its child nodes move is not seen, unless a channel says otherwise */
#define RT_NODE_OWN_VISIBILITY 2u /* it may be seen even where its parent is not */
/* A node: the transform of everything that hangs on it, and of its child nodes. The node's own transform is
 *     translation * before_rotation * rotation * after_rotation * scale * after_scale
 * The constant matrices in between hold pivots, offsets and pre-rotations. A matrix that is all 0 counts as the identity. */
typedef struct rt_node_desc {
    rt_u32 struct_bytes;
    rt_u32 parent;    /* id of a node; 0: none */
    const char *name; /* or NULL */
    rt_u32 rotation_order; /* RT_ROTATE_XYZ: about x first, then y, then z (as FBX's eEulerXYZ); ...; RT_ROTATE_QUATERNION */
    rt_u32 inherit;        /* RT_INHERIT_... */
    double translation[3];
    double rotation[4]; /* degrees about x, y and z; or the quaternion x y z w, which need not be unit */
    double scale[3];
    double before_rotation[12], after_rotation[12], after_scale[12];
    rt_u32 flags; /* RT_NODE_... */
    rt_u32 pad;   /* 0 */
} rt_node_desc;

/* How the values of a layer meet those of the layers below it. The first layer always replaces the values at rest. */
enum {
    RT_LAYER_ADDS,     /* sums, times the weight; for rotations and scales as the layer says */
    RT_LAYER_REPLACES, /* the value of this layer */
    RT_LAYER_BLENDS    /* between the value below and this one, by the weight */
};
#define RT_LAYER_ROTATES_BY_CHANNEL 1u /* angles are summed and blended one by one; otherwise rotations are multiplied */
#define RT_LAYER_ADDS_SCALES 2u        /* scales are summed and blended; otherwise they are multiplied */
/* A layer of a clip. 16 B; it never grows. */
typedef struct rt_layer {
    rt_u32 mode; /* RT_LAYER_ADDS, ... */
    rt_u32 flags;
    double weight; /* 0..1, unless a channel says otherwise */
} rt_layer;
typedef struct rt_clip_desc {
    rt_u32 struct_bytes;
    rt_u32 layer_count; /* 0: one layer that replaces */
    const char *name;   /* or NULL */
    double begin_s, end_s;
    double fps; /* frames a second, as the file says; 0: it does not say */
    const rt_layer *layers;
} rt_clip_desc;

/* What a channel moves, and which ids `target` counts in. Numbers: components 0..2 are x, y, z or red, green, blue. */
enum {
    RT_MOVES_TRANSLATION, /* of a node */
    RT_MOVES_ROTATION,    /* of a node: degrees, or the quaternion as a whole: RT_ALL_COMPONENTS, 4 numbers a key */
    RT_MOVES_SCALE,       /* of a node */
    RT_MOVES_VISIBILITY,  /* of a node: seen if the value is 0.5 or more */
    RT_MOVES_MORPH,       /* the weight of a morph */
    RT_MOVES_LAYER,       /* the weight of the layer with the number `target` in this clip */
    RT_MOVES_FOV,         /* of a camera: the vertical angle in radians */
    RT_MOVES_COLOR        /* of a light */
};
#define RT_ALL_COMPONENTS 3u
/* The span between a key and the next one. */
enum {
    RT_SPAN_LINEAR,    /* quaternions: along the shorter arc */
    RT_SPAN_STEP,      /* the first key's value */
    RT_SPAN_STEP_NEXT, /* the second key's value */
    RT_SPAN_CUBIC      /* a Bezier curve in time and value through the handles; quaternions are made unit afterwards */
};
/* Outside of its keys. */
enum {
    RT_OUTSIDE_HOLD,            /* the value of the first or last key */
    RT_OUTSIDE_REPEAT,          /* all keys again */
    RT_OUTSIDE_MIRROR,          /* all keys again, every other time backwards */
    RT_OUTSIDE_SLOPE,           /* straight on in the direction of the first or last span */
    RT_OUTSIDE_REPEAT_RELATIVE  /* all keys again, beginning at the value where they ended */
};
/* The keys of one component, or of a quaternion, in one layer of a clip. Components without a channel keep the value at rest, or in
 * layers that add, add nothing. */
typedef struct rt_channel_desc {
    rt_u32 struct_bytes;
    rt_u32 clip;      /* id */
    rt_u32 layer;     /* number within the clip, from 0 */
    rt_u32 moves;     /* RT_MOVES_... */
    rt_u32 target;    /* id of a node or morph; id that the sink's `camera` or `light` returned; number of a layer */
    rt_u32 component; /* 0, 1, 2 or RT_ALL_COMPONENTS; 0 where there is one number only */
    uint64_t key_count;     /* 1 or more */
    const double *times_s;  /* one for each key; none is less than the one before */
    const double *values;   /* one for each key; of quaternions 4: x y z w */
    const uint8_t *spans;   /* RT_SPAN_..., one for each key, the last one unused; NULL: all are linear */
    const double *handles;  /* four for each value: in seconds, in value, out seconds, out value. The curve's control points lie at
                             * key - in and key + out. NULL if no span is cubic */
    rt_u32 before, after;   /* RT_OUTSIDE_... */
    rt_u32 before_count, after_count; /* how many times keys are repeated; 0: without end */
} rt_channel_desc;

/* A bone of a skin. 104 B; it never grows. */
typedef struct rt_bone {
    rt_u32 node; /* id */
    rt_u32 pad;  /* 0 */
    double bone_from_mesh[12]; /* where vertices of the mesh are in the node's space when the mesh is at rest on its bones */
} rt_bone;
/* 12 B; it never grows. */
typedef struct rt_weight {
    rt_u32 vertex, bone; /* bone: number within the skin, from 0 */
    float weight;        /* the host divides the weights of a vertex by their sum */
} rt_weight;
enum { RT_SKIN_LINEAR, RT_SKIN_DUAL_QUATERNION, RT_SKIN_BLENDED };
/* Bones move the vertices of a mesh; the node of its instance then has no effect on them. Vertices without weights stay with that
 * node. A mesh has one skin at most. It acts also at rest, unless the user asks for meshes as they are stored. */
typedef struct rt_skin_desc {
    rt_u32 struct_bytes;
    rt_u32 mesh; /* id that the sink's `mesh` returned */
    rt_u32 bone_count, method; /* RT_SKIN_... */
    const rt_bone *bones;
    const rt_weight *weights; /* in any order */
    uint64_t weight_count;
    const float *dual_quaternion_shares; /* per vertex, 0..1, for RT_SKIN_BLENDED; otherwise NULL */
} rt_skin_desc;

/* A shape that a morph reaches at one weight. 48 B; it never grows. */
typedef struct rt_morph_target {
    double weight; /* 1, or less for shapes in between; not 0 */
    const rt_u32 *vertices; /* `count` different ones that move; NULL: the first `count` */
    uint64_t count;
    const float *positions; /* 3 for each: how far it moves */
    const float *normals;   /* 3 for each: how much its normal changes; or NULL */
    uint64_t pad;           /* 0 */
} rt_morph_target;
/* A morph: offsets of a mesh's vertices, times a weight. Between two of its targets the offsets are interpolated; the mesh as
 * it is stored is the target at weight 0. All morphs of a mesh are added, then its skin acts. */
typedef struct rt_morph_desc {
    rt_u32 struct_bytes;
    rt_u32 mesh;      /* id that the sink's `mesh` returned */
    const char *name; /* or NULL */
    double weight;    /* at rest; there it acts as a skin does */
    const rt_morph_target *targets; /* in order of their weights */
    rt_u32 target_count, pad;
} rt_morph_desc;

/* All vertices of a mesh at several times, which replace those at rest: a geometry cache. Between two times they move straight. */
typedef struct rt_vertex_frames {
    rt_u32 struct_bytes;
    rt_u32 mesh; /* id that the sink's `mesh` returned */
    uint64_t frame_count;
    const double *times_s;  /* increasing */
    const float *positions; /* 3 for each vertex of each frame */
} rt_vertex_frames;

/* What lies beyond the scene and lights it. Colours are linear radiance. */
typedef struct rt_sky_desc {
    rt_u32 struct_bytes;
    rt_u32 kind;      /* RT_SKY_* */
    const char *path; /* of the picture: HDR, EXR, PFM or PNG, as wide as all directions, the zenith in the top row, +X in the middle
                       * column and +Z a quarter to the right of it */
    float rotate_deg; /* about +Y, counter-clockwise seen from above */
    float strength;   /* factor of all of it */
    float color[3];   /* of a gradient at the zenith; factor of a picture */
    float horizon[3], ground[3]; /* of a gradient: at the horizon, and below it */
    rt_u32 hidden;    /* not 0: camera rays see the background instead */
    const rt_texture_desc *faces[6]; /* appended: of a picture, in place of `path`: six square ones as large as each other, of what is seen along +X, -X,
                                      * +Y, -Y, +Z and -Z. Up in them is +Y, of +Y -Z, of -Y +Z. The light is rgb, which is in sRGB, divided by alpha; or NULL */
    float turn[4];                   /* appended: by which the six are turned: a unit quaternion x, y, z, w */
} rt_sky_desc;

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
    /* Appended: ask RT_HAS first. The kinds are numbered from 0; NULL: there is no such number. */
    const rt_primitive_kind *(*primitive_kind)(void *ctx, rt_u32 number);
    rt_u32 (*primitive)(void *ctx, const rt_primitive_desc *);
    rt_u32 (*node)(void *ctx, const rt_node_desc *); /* after its parent */
    rt_u32 (*clip)(void *ctx, const rt_clip_desc *); /* in the order of the file: the first one acts if the user names none */
    rt_u32 (*morph)(void *ctx, const rt_morph_desc *);
    /* These return RT_OK, or RT_FAILED with the error recorded. */
    int32_t (*channel)(void *ctx, const rt_channel_desc *);
    int32_t (*skin)(void *ctx, const rt_skin_desc *);
    int32_t (*vertex_frames)(void *ctx, const rt_vertex_frames *);
    /* Appended. A change of what the file holds together with the files that it loads, in the words of `clarity render --set`:
     * "instance.3.translate" and "1,0,0". Keys are instance.N..., material.N..., light.N and sky..., counted as `clarity info` counts them.
     * The value of a map's use, as material.3.normal_map, is "none", "#7" for the 7 that `texture` returned, or the name of a texture.
     * where: "FILE:LINE:COLUMN" of the statement, or NULL. Returns RT_OK, or RT_FAILED with the error recorded. */
    int32_t (*edit)(void *ctx, const char *key, const char *value, const char *where);
    /* Appended. The keys of lights of a kind: RT_LIGHT_POINT, ...; NULL: there is no such kind. And those of materials. */
    const rt_primitive_kind *(*light_kind)(void *ctx, rt_u32 kind);
    const rt_primitive_kind *(*material_kind)(void *ctx);
    /* Appended. The first file that states a sky counts. A missing or broken picture is a warning. RT_OK, or RT_FAILED with the error
     * recorded. */
    int32_t (*sky)(void *ctx, const rt_sky_desc *);
    /* Appended. The keys of skies of a kind: RT_SKY_CONSTANT, ...; NULL: there is no such kind. */
    const rt_primitive_kind *(*sky_kind)(void *ctx, rt_u32 kind);
    /* Appended. The uses of textures by materials, as keys: key n is RT_MAP_ n. */
    const rt_primitive_kind *(*map_kind)(void *ctx);
} rt_scene_sink;

#define RT_IMPORTER_TAKES_CONTENT 1u /* it reads rt_host::content if there is some; others get no packed files */
typedef struct rt_importer {
    rt_u32 struct_bytes;
    const char *const *extensions; /* lower case, no dot, NULL-terminated */
    int32_t (*probe)(const uint8_t *head, uint64_t bytes); /* 0..100 certainty by the first bytes; or NULL: extension only */
    int32_t (*load)(const rt_host *, const char *path, const double *params, const rt_scene_sink *);
    rt_u32 flags; /* appended: RT_IMPORTER_... */
    rt_u32 pad;   /* 0 */
} rt_importer;

/* ---- the description ------------------------------------------------------------------------------------------------------ */

/* Something that a plugin offers beyond this file, such as refitting or building on the device. Extensions are frozen one by one,
 * each in a header of its own that names the struct behind `data`: rt_refit.h. Names without a dot belong to Clarity. A host ignores
 * extensions and versions that it does not know. */
typedef struct rt_extension {
    const char *name;  /* NULL ends the array */
    rt_u32 version;
    rt_u32 data_bytes; /* size of *data, at least that of the version's first release */
    const void *data;
} rt_extension;

typedef struct rt_plugin {
    rt_u32 abi_version, struct_bytes, types_digest, param_count; /* first in every version */
    const char *id, *name, *version, *reference; /* id: [a-z][a-z0-9_]*, also the prefix of its CL names; reference: paper, or NULL */
    const rt_param *params;
    const rt_accel *accel; /* exactly one of accel, importer and primitive is not NULL */
    const rt_importer *importer;
    const rt_extension *extensions; /* or NULL */
    rt_u32 param_bytes, extension_bytes; /* sizeof(rt_param), sizeof(rt_extension) */
    const rt_primitive *primitive;       /* appended */
} rt_plugin;

RT_EXPORT extern const rt_plugin rt_plugin_v1; /* the only exported symbol; data, not code */
#ifdef __cplusplus
}
#endif
#include "rt_digest.h" /* RT_TYPES_DIGEST */
#endif
