/* rt_plugin.h -- the plugin ABI, version 2, as it was when it was frozen, without its comments: sdk/rt_plugin.h has them. */
#ifndef RT_PLUGIN_H
#define RT_PLUGIN_H
#include <stddef.h>
#include "rt_shared.h"
#define RT_ABI_VERSION 2u
#define RT_KERNEL_CONTRACT 1u
#ifdef _WIN32
#define RT_EXPORT __declspec(dllexport)
#else
#define RT_EXPORT __attribute__((visibility("default")))
#endif
#ifdef __cplusplus
extern "C" {
#endif
#define RT_HAS(pointer, type, field) ((pointer)->struct_bytes >= offsetof(type, field) + sizeof((pointer)->field))
enum { RT_OK = 0, RT_FAILED = 1, RT_CANCELLED = 2 };
enum { RT_LOG_DEBUG, RT_LOG_INFO, RT_LOG_WARNING };
typedef struct rt_host {
    rt_u32 struct_bytes;
    void *ctx;
    int32_t (*fail)(void *ctx, const char *why);
    void (*log)(void *ctx, int32_t level, const char *text);
    int32_t (*progress)(void *ctx, float fraction);
    void (*parallel_for)(void *ctx, rt_u32 count, void (*body)(void *user, rt_u32 i), void *user);
} rt_host;
enum { RT_PARAM_INT, RT_PARAM_FLOAT, RT_PARAM_BOOL, RT_PARAM_ENUM };
enum { RT_EFFECT_REBUILD, RT_EFFECT_RECOMPILE };
typedef struct rt_param {
    const char *key, *label, *help;
    int32_t kind, effect;
    double min, max, def;
    const char *const *choices;
} rt_param;
typedef struct rt_prim {
    float lo[3];
    rt_u32 ref;
    float hi[3];
    rt_u32 mesh;
} rt_prim;
typedef struct rt_group {
    rt_u32 first, count;
} rt_group;
typedef struct rt_geometry {
    rt_u32 struct_bytes;
    const rt_packed_prim *triangles;
    uint64_t triangle_count;
} rt_geometry;
enum { RT_DEVICE_UNKNOWN, RT_DEVICE_CPU, RT_DEVICE_GPU };
typedef struct rt_device {
    rt_u32 struct_bytes;
    rt_u32 kind;
    rt_u32 lanes;
    rt_u32 compute_units;
    rt_u32 cache_line_bytes;
    rt_u32 local_bytes;
    uint64_t unit_cache_bytes;
    uint64_t shared_cache_bytes;
    uint64_t memory_bytes;
} rt_device;
typedef struct rt_build_input {
    rt_u32 struct_bytes, group_count;
    const rt_prim *prims;
    const rt_group *groups;
    const rt_geometry *geometry;
    const double *params;
    const rt_device *device;
    const uint8_t *wanted;
    const uint64_t *first_elements;
    uint64_t first_leaf;
} rt_build_input;
typedef struct rt_build_output {
    rt_u32 struct_bytes;
    void *ctx;
    void *(*alloc)(void *ctx, rt_u32 slot, uint64_t count);
    rt_u32 *(*leaves)(void *ctx, uint64_t count);
    void (*root)(void *ctx, rt_u32 group, rt_u32 node);
    void (*define)(void *ctx, const char *name, rt_u32 value);
    void (*stat)(void *ctx, const char *label, double value);
} rt_build_output;
#define RT_SLOT_HOST_ONLY 1u
typedef struct rt_slot {
    const char *name, *cl_type;
    rt_u32 elem_bytes;
    rt_u32 flags;
} rt_slot;
typedef struct rt_cl_file {
    const char *name, *text;
} rt_cl_file;
typedef struct rt_built {
    rt_u32 struct_bytes, group_count;
    const void *const *slots;
    const uint64_t *slot_counts;
    const rt_u32 *roots;
} rt_built;
#define RT_LEVEL_BOTTOM 0xFFFFFFFFu
typedef struct rt_volume_sink {
    rt_u32 struct_bytes;
    void *ctx;
    void (*box)(void *ctx, const float lo[3], const float hi[3]);
    void (*sphere)(void *ctx, const float center[3], float radius);
} rt_volume_sink;
typedef struct rt_topology_node {
    float lo[3];
    rt_u32 left;
    float hi[3];
    rt_u32 right;
} rt_topology_node;
#define RT_TOPOLOGY_LEAF 0x80000000u
#define RT_TOPOLOGY_DEPTH 256u
typedef struct rt_topology_output {
    rt_u32 struct_bytes;
    void *ctx;
    rt_topology_node *(*nodes)(void *ctx, uint64_t count);
    rt_u32 *(*refs)(void *ctx, uint64_t count);
    void (*root)(void *ctx, rt_u32 group, rt_u32 node);
    void (*stat)(void *ctx, const char *label, double value);
} rt_topology_output;
typedef struct rt_topology {
    rt_u32 struct_bytes, group_count;
    const rt_topology_node *nodes;
    uint64_t node_count;
    const rt_u32 *refs;
    uint64_t ref_count;
    const rt_u32 *roots;
} rt_topology;
enum {
    RT_TRAVERSES_STREAMS = 1,
    RT_TRAVERSES_STEPS = 2,
    RT_TRAVERSES_WARPS = 4,
    RT_REQUEUES_LONG_RAYS = 8,
    RT_SPLITS_INCOHERENT = 16,
    RT_BUILDS_GROUPS = 32
};
enum { RT_RAY_COST_LOGARITHMIC, RT_RAY_COST_LINEAR };
typedef struct rt_accel {
    rt_u32 struct_bytes;
    rt_u32 kernel_contract;
    rt_u32 slot_count, slot_bytes;
    const rt_slot *slots;
    rt_cl_file types;
    rt_cl_file traverse;
    int32_t (*build)(const rt_host *, const rt_build_input *, const rt_build_output *);
    int32_t (*levels)(const rt_host *, const rt_built *, rt_u32 group, rt_u32 level, const rt_volume_sink *);
    int32_t (*pack)(const rt_host *, const rt_build_input *, const rt_topology *, const rt_build_output *);
    const char *layout;
    int32_t (*topology)(const rt_host *, const rt_build_input *, const rt_topology_output *);
    rt_u32 capabilities;
    float merit_cpu, merit_gpu;
    rt_u32 ray_cost;
} rt_accel;
typedef struct rt_mesh {
    rt_u32 struct_bytes;
    rt_u32 material;
    const char *name;
    const float *positions;
    rt_u32 vertex_count, position_stride;
    const float *normals;
    rt_u32 normal_stride;
    const float *uvs;
    rt_u32 uv_stride;
    const rt_u32 *indices;
    uint64_t index_count;
    const rt_u32 *face_sizes;
    uint64_t face_count;
    const rt_u32 *face_materials;
} rt_mesh;
typedef struct rt_instance_desc {
    rt_u32 struct_bytes;
    const char *name;
    rt_u32 mesh;
    rt_u32 material;
    float world_from_object[12];
} rt_instance_desc;
typedef struct rt_material_desc {
    rt_u32 struct_bytes;
    rt_u32 flags;
    const char *name;
    float color[3];
    float reflect;
    float emission[3];
    float refract;
    float specular[3];
    float shininess;
    float ior;
    rt_u32 texture;
} rt_material_desc;
typedef struct rt_texture_desc {
    rt_u32 struct_bytes;
    const char *path;
    const uint8_t *bytes;
    uint64_t byte_count;
    rt_u32 width, height;
} rt_texture_desc;
typedef struct rt_camera {
    rt_u32 struct_bytes;
    const char *name;
    float eye[3], target[3], up[3];
    float fov_y_rad;
} rt_camera;
typedef struct rt_light_desc {
    rt_u32 struct_bytes;
    rt_u32 kind;
    const char *name;
    float position[3];
    float direction[3];
    float color[3];
    rt_u32 pad;
} rt_light_desc;
typedef struct rt_load {
    rt_u32 struct_bytes;
    const char *path;
    const char *name;
    float world_from_object[12];
    rt_u32 material;
    const char *where;
} rt_load;
typedef struct rt_scene_info {
    rt_u32 struct_bytes;
    rt_u32 up_axis;
    double unit_scale;
    const float *background;
    const float *ambient;
} rt_scene_info;
typedef struct rt_scene_sink {
    rt_u32 struct_bytes;
    void *ctx;
    rt_u32 (*texture)(void *ctx, const rt_texture_desc *);
    rt_u32 (*material)(void *ctx, const rt_material_desc *);
    rt_u32 (*mesh)(void *ctx, const rt_mesh *);
    rt_u32 (*instance)(void *ctx, const rt_instance_desc *);
    rt_u32 (*sphere)(void *ctx, const float center[3], float radius, rt_u32 material);
    rt_u32 (*plane)(void *ctx, const float normal[3], float offset, rt_u32 material);
    rt_u32 (*polygon)(void *ctx, const float *corners, rt_u32 corner_count, rt_u32 material);
    rt_u32 (*light)(void *ctx, const rt_light_desc *);
    rt_u32 (*camera)(void *ctx, const rt_camera *);
    void (*info)(void *ctx, const rt_scene_info *);
    void (*warn)(void *ctx, const char *text);
    int32_t (*load)(void *ctx, const rt_load *);
} rt_scene_sink;
typedef struct rt_importer {
    rt_u32 struct_bytes;
    const char *const *extensions;
    int32_t (*probe)(const uint8_t *head, uint64_t bytes);
    int32_t (*load)(const rt_host *, const char *path, const double *params, const rt_scene_sink *);
} rt_importer;
typedef struct rt_extension {
    const char *name;
    rt_u32 version;
    rt_u32 data_bytes;
    const void *data;
} rt_extension;
typedef struct rt_plugin {
    rt_u32 abi_version, struct_bytes, types_digest, param_count;
    const char *id, *name, *version, *reference;
    const rt_param *params;
    const rt_accel *accel;
    const rt_importer *importer;
    const rt_extension *extensions;
    rt_u32 param_bytes, extension_bytes;
} rt_plugin;
RT_EXPORT extern const rt_plugin rt_plugin_v1;
#ifdef __cplusplus
}
#endif
#include "rt_digest.h"
#endif
