// rt_plugin.hpp -- C++17 helpers on top of rt_plugin.h, for plugins. They are header only and compiled into the plugin, so that
// only the C structs of rt_plugin.h are shared with the host.
//
//   static int32_t build(const rt_host* host, const rt_build_input* in, const rt_build_output* out) { ...may throw... }
//   constexpr rt_accel accel = rt::accel(slots, types, traverse, rt::guarded<build>, nullptr, rt::Traits());
//   const rt_plugin rt_plugin_v1 = rt::accel_plugin("mine", "My structure", "1.0.0", nullptr, params, accel);
//
// rt_plugin_v1 must be a constant, because the host reads its first words from the file. Everything that it needs here is
// constexpr.
#pragma once
#include <atomic>
#include <cmath>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <type_traits>
#include <utility>

#include "rt_plugin.h"
#include "rt_refit.h"

namespace rt {

// ---- errors -----------------------------------------------------------------------------------------------------------------

// Thrown where the host has already recorded the reason (alloc returned NULL), so that none is added.
struct Stopped : std::exception {
    const char* what() const noexcept override { return "stopped by the host"; }
};
// What a plugin says where it gets no memory: the host knows this reason from others.
inline constexpr const char* kOutOfMemory = "out of memory";
// Thrown when the user has cancelled.
struct Cancelled : std::exception {
    const char* what() const noexcept override { return "cancelled"; }
};

namespace detail {

template <auto F>
struct Guard;
template <class... Args, int32_t (*F)(const rt_host*, Args...)>
struct Guard<F> {
    static int32_t call(const rt_host* host, Args... args) noexcept {
        try {
            return F(host, args...);
        } catch (const Cancelled&) {
            return RT_CANCELLED;
        } catch (const Stopped&) {
            return RT_FAILED;
        } catch (const std::bad_alloc&) {
            return host->fail(host->ctx, kOutOfMemory);
        } catch (const std::exception& e) {
            return host->fail(host->ctx, e.what());
        } catch (...) {
            return host->fail(host->ctx, "an exception of unknown type");
        }
    }
};

constexpr bool same_text(const char* a, const char* b) {
    for (; *a && *a == *b; ++a, ++b) {
    }
    return *a == *b;
}

}  // namespace detail

// Wraps a plugin function for the host: an exception becomes host->fail(what) and a status.
template <auto F>
inline constexpr auto guarded = &detail::Guard<F>::call;

// throw rt::fail(host, "vertex 7 is not finite"): the host records the reason, and the exception ends in `guarded`.
[[nodiscard]] inline Stopped fail(const rt_host* host, const std::string& why) {
    host->fail(host->ctx, why.c_str());
    return {};
}

// ---- services ---------------------------------------------------------------------------------------------------------------

// Writes one line to the program's log. level: RT_LOG_...
inline void log(const rt_host* host, int32_t level, const std::string& text) {
    host->log(host->ctx, level, text.c_str());
}

// Reports progress, 0..1. Throws Cancelled once the user no longer wants the result.
inline void progress(const rt_host* host, float fraction) {
    if (!host->progress(host->ctx, fraction)) throw Cancelled();
}

// Calls body(i) for every i in [0, count) on all cores. Calls may be nested. After an exception the remaining bodies are
// skipped, and the first exception is thrown here.
template <class Body>
void parallel_for(const rt_host* host, rt_u32 count, Body&& body) {
    struct Loop {
        std::remove_reference_t<Body>& body;
        std::atomic<bool> failed{false};
        std::mutex mutex;
        std::exception_ptr exception;
    } loop{body, {}, {}, {}};
    host->parallel_for(
        host->ctx, count,
        [](void* user, rt_u32 i) {
            Loop& l = *static_cast<Loop*>(user);
            if (l.failed.load(std::memory_order_relaxed)) return;
            try {
                l.body(i);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(l.mutex);
                if (!l.failed.exchange(true)) l.exception = std::current_exception();
            }
        },
        &loop);
    if (loop.exception) std::rethrow_exception(loop.exception);
}

// ---- parameters -------------------------------------------------------------------------------------------------------------

constexpr rt_param int_param(const char* key, const char* label, const char* help, int min, int max, int def,
                             int32_t effect = RT_EFFECT_REBUILD) {
    return {key, label, help, RT_PARAM_INT, effect, double(min), double(max), double(def), nullptr};
}
constexpr rt_param float_param(const char* key, const char* label, const char* help, double min, double max, double def,
                               int32_t effect = RT_EFFECT_REBUILD) {
    return {key, label, help, RT_PARAM_FLOAT, effect, min, max, def, nullptr};
}
constexpr rt_param bool_param(const char* key, const char* label, const char* help, bool def,
                              int32_t effect = RT_EFFECT_REBUILD) {
    return {key, label, help, RT_PARAM_BOOL, effect, 0, 1, def ? 1.0 : 0.0, nullptr};
}
// choices: a static array of names which ends with nullptr.
template <size_t N>
constexpr rt_param enum_param(const char* key, const char* label, const char* help, const char* const (&choices)[N], int def,
                              int32_t effect = RT_EFFECT_REBUILD) {
    return {key, label, help, RT_PARAM_ENUM, effect, 0, double(N) - 2, double(def), choices};
}

// ---- acceleration structures ------------------------------------------------------------------------------------------------

// Describes a slot. The element type in C++ also gives its size: rt::slot<bvh2_node>("nodes", "bvh2_node").
template <class T>
constexpr rt_slot slot(const char* name, const char* cl_type) {
    static_assert(std::is_trivially_copyable_v<T>, "slots are copied to a device byte by byte");
    return {name, cl_type, rt_u32(sizeof(T)), 0};
}
// Describes a slot that stays on the host, for `levels`.
template <class T>
constexpr rt_slot host_slot(const char* name) {
    return {name, nullptr, rt_u32(sizeof(T)), RT_SLOT_HOST_ONLY};
}

// One of the files that clarity_add_plugin embedded: constexpr rt_cl_file files[] = {
// #include "mine.inc"
// };  rt::file(files, "mine.cl"). {nullptr, nullptr} if it is not there.
template <size_t N>
constexpr rt_cl_file file(const rt_cl_file (&files)[N], const char* name) {
    for (const rt_cl_file& f : files)
        if (detail::same_text(f.name, name)) return f;
    return {nullptr, nullptr};
}

// What a structure can do, and how fast it is expected to be; rt_plugin.h has the units. Each call returns the changed traits:
// rt::Traits().can(RT_TRAVERSES_STREAMS).merit(1.4f, 0.5f).
struct Traits {
    rt_u32 capabilities = 0;
    float merit_cpu = 0, merit_gpu = 0;
    rt_u32 ray_cost = RT_RAY_COST_LOGARITHMIC;
    constexpr Traits can(rt_u32 bits) const { return {capabilities | bits, merit_cpu, merit_gpu, ray_cost}; }
    constexpr Traits merit(float cpu, float gpu) const { return {capabilities, cpu, gpu, ray_cost}; }
    constexpr Traits tests_everything() const { return {capabilities, merit_cpu, merit_gpu, RT_RAY_COST_LINEAR}; }
};

using Build = int32_t (*)(const rt_host*, const rt_build_input*, const rt_build_output*);
using Levels = int32_t (*)(const rt_host*, const rt_built*, rt_u32 group, rt_u32 level, const rt_volume_sink*);
using Pack = int32_t (*)(const rt_host*, const rt_build_input*, const rt_topology*, const rt_build_output*);
using BuildTopology = int32_t (*)(const rt_host*, const rt_build_input*, const rt_topology_output*);
// The description of a structure. levels: nullptr if it has no bounding volumes to draw. pack: nullptr if it cannot take the
// tree of another plugin.
template <size_t N>
constexpr rt_accel accel(const rt_slot (&slots)[N], const rt_cl_file& types, const rt_cl_file& traverse, Build build,
                         Levels levels, const Traits& traits, Pack pack = nullptr) {
    return {sizeof(rt_accel),
            RT_KERNEL_CONTRACT,
            N,
            sizeof(rt_slot),
            slots,
            types,
            traverse,
            build,
            levels,
            pack,
            nullptr,
            nullptr,
            traits.capabilities,
            traits.merit_cpu,
            traits.merit_gpu,
            traits.ray_cost};
}
// The description of a structure that builds only a binary tree. layout: id of the structure that packs and traces it, "bvh2".
constexpr rt_accel topology(const char* layout, BuildTopology build, const Traits& traits) {
    return {sizeof(rt_accel),
            0,
            0,
            0,
            nullptr,
            {},
            {},
            nullptr,
            nullptr,
            nullptr,
            layout,
            build,
            0,
            traits.merit_cpu,
            traits.merit_gpu,
            traits.ray_cost};
}

// Allocates zeroed host memory for `count` elements of a slot. Call it once per slot. Throws Stopped if there is no memory.
template <class T>
T* alloc(const rt_build_output* out, rt_u32 slot, uint64_t count) {
    auto* memory = static_cast<T*>(out->alloc(out->ctx, slot, count));
    if (!memory) throw Stopped();
    return memory;
}
// Allocates the array of `count` primitive refs, which the builder fills in leaf order. Call it once per build. Throws Stopped
// if there is no memory.
inline rt_u32* leaves(const rt_build_output* out, uint64_t count) {
    rt_u32* refs = out->leaves(out->ctx, count);
    if (!refs) throw Stopped();
    return refs;
}
// The three functions below forward to the functions of rt_build_output, which rt_plugin.h explains.
inline void root(const rt_build_output* out, rt_u32 group, rt_u32 node) {
    out->root(out->ctx, group, node);
}
inline void define(const rt_build_output* out, const char* name, rt_u32 value) {
    out->define(out->ctx, name, value);
}
inline void stat(const rt_build_output* out, const char* label, double value) {
    out->stat(out->ctx, label, value);
}

// ---- topologies -------------------------------------------------------------------------------------------------------------

// Allocates `count` zeroed nodes, at most as many as will be needed. Call it once per build. Throws Stopped if there is no
// memory.
inline rt_topology_node* nodes(const rt_topology_output* out, uint64_t count) {
    rt_topology_node* memory = out->nodes(out->ctx, count);
    if (!memory) throw Stopped();
    return memory;
}
// Allocates the array of `count` refs, which the builder fills in leaf order. Call it once per build. Throws Stopped if there
// is no memory.
inline rt_u32* refs(const rt_topology_output* out, uint64_t count) {
    rt_u32* memory = out->refs(out->ctx, count);
    if (!memory) throw Stopped();
    return memory;
}
inline void root(const rt_topology_output* out, rt_u32 group, rt_u32 node) {
    out->root(out->ctx, group, node);
}
inline void stat(const rt_topology_output* out, const char* label, double value) {
    out->stat(out->ctx, label, value);
}

// ---- refit ------------------------------------------------------------------------------------------------------------------

using Refit = int32_t (*)(const rt_host*, const rt_refit_input*, const rt_refit_output*);
// The extension `refit` (rt_refit.h), for with_extensions() below:
//   constexpr rt_refit kRefit = rt::refit(rt::guarded<refit>);
//   constexpr rt_extension kExtensions[] = {rt::extension(kRefit), rt::kNoMoreExtensions};
constexpr rt_refit refit(Refit call) {
    return {sizeof(rt_refit), 0, call};
}
constexpr rt_extension extension(const rt_refit& data) {
    return {RT_REFIT, RT_REFIT_VERSION, sizeof data, &data};
}
constexpr rt_extension kNoMoreExtensions = {nullptr, 0, 0, nullptr};

// Fetches the primitives at `count` positions in leaf order. Throws Stopped if there are no such positions.
inline void prims(const rt_refit_input* in, uint64_t first, uint64_t count, rt_prim* prims) {
    if (in->prims(in->ctx, first, count, prims) != RT_OK) throw Stopped();
}

// ---- shapes -----------------------------------------------------------------------------------------------------------------

// The keys of a shape. Without a default, a key is required.
constexpr rt_key number_key(const char* name, const char* help, double min, double max) {
    return {name, help, RT_KEY_NUMBER, RT_KEY_REQUIRED, min, max, {}, nullptr};
}
constexpr rt_key number_key(const char* name, const char* help, double min, double max, double def) {
    return {name, help, RT_KEY_NUMBER, 0, min, max, {def, 0, 0}, nullptr};
}
constexpr rt_key whole_key(const char* name, const char* help, int min, int max, int def) {
    return {name, help, RT_KEY_WHOLE, 0, double(min), double(max), {double(def), 0, 0}, nullptr};
}
// kind: RT_KEY_POINT, RT_KEY_VECTOR, RT_KEY_NUMBERS or RT_KEY_POINTS.
constexpr rt_key key(rt_u32 kind, const char* name, const char* help) {
    return {name, help, kind, RT_KEY_REQUIRED, -1e15, 1e15, {}, nullptr};
}
constexpr rt_key key(rt_u32 kind, const char* name, const char* help, double x, double y, double z) {
    return {name, help, kind, 0, -1e15, 1e15, {x, y, z}, nullptr};
}
// A list that may be left out.
constexpr rt_key list_key(rt_u32 kind, const char* name, const char* help) {
    return {name, help, kind, 0, -1e15, 1e15, {}, nullptr};
}

using ShapeBounds = int32_t (*)(const rt_host*, const rt_key_values*, float lo[3], float hi[3]);
using ShapePrepare = int32_t (*)(const rt_host*, const rt_key_values*, const rt_shape_output*);
// The description of a shape. flags: RT_SHAPE_SINGLE_RAY or 0.
template <size_t N>
constexpr rt_primitive primitive(const rt_key (&keys)[N], const rt_cl_file& kernels, ShapeBounds bounds, ShapePrepare prepare,
                                 rt_u32 flags = 0) {
    return {sizeof(rt_primitive), RT_KERNEL_CONTRACT, N, sizeof(rt_key), keys, kernels, bounds, prepare, flags, 0};
}
// How far a disc of this radius reaches from its centre along an axis. n: that axis' component of the disc's unit normal.
inline double disc_reach(double radius, double n) {
    return radius * std::sqrt(std::fmax(0.0, 1 - n * n));
}
// Hands over one part of a shape. Throws Stopped if the host refuses it.
inline void part(const rt_shape_output* out, const float lo[3], const float hi[3], const float* numbers, rt_u32 count,
                 const float* more = nullptr, uint64_t more_count = 0) {
    if (out->part(out->ctx, lo, hi, numbers, count, more, more_count) != RT_OK) throw Stopped();
}

// ---- importers --------------------------------------------------------------------------------------------------------------

// A material of the values that the host gives to objects without one.
constexpr rt_material_desc material(const char* name = nullptr) {
    rt_material_desc m{};
    m.struct_bytes = sizeof m;
    m.name = name;
    for (float& c : m.color) c = 0.7f;
    for (float& c : m.specular) c = 0.15f;
    m.shininess = 32;
    m.ior = 1.5f;
    m.texture = RT_NONE;
    return m;
}
// A use of a texture in the mesh's first set of coordinates. use: RT_MAP_COLOR, ...
constexpr rt_map_desc map(rt_u32 use, rt_u32 texture) {
    return {use, texture, 0, 1, {1, 0, 0, 0, 1, 0}};
}
// A white light at the origin, or one that shines downwards. kind: RT_LIGHT_POINT, ...
constexpr rt_light_desc light(rt_u32 kind, const char* name = nullptr) {
    return {sizeof(rt_light_desc), kind, name, {0, 0, 0}, {0, -1, 0}, {1, 1, 1}, 0, 0, 0, nullptr, 0, 0};
}

// The value of a key of a light or a material: rt::value("angle", 30).
constexpr rt_key_value value(const char* key, float x, float y = 0, float z = 0) {
    return {key, {x, y, z}, 0};
}

// A mesh that is placed where its vertices are.
constexpr rt_instance_desc instance(rt_u32 mesh, const char* name = nullptr) {
    return {sizeof(rt_instance_desc), name, mesh, RT_NONE, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, 0, 0, nullptr};
}

// Tells the user of something that was left out: `info` and the window show it.
inline void warn(const rt_scene_sink& sink, const std::string& text) {
    sink.warn(sink.ctx, text.c_str());
}

// Returns an id that the sink gave, or throws Stopped if it gave none: rt::id(sink->mesh(sink->ctx, &mesh)). Do not use it for
// textures: a texture may be missing without an error.
inline rt_u32 id(rt_u32 answer) {
    if (answer == RT_NONE) throw Stopped();
    return answer;
}

// ---- the description --------------------------------------------------------------------------------------------------------

namespace detail {
constexpr rt_plugin plugin(const char* id, const char* name, const char* version, const char* reference, const rt_param* params,
                           rt_u32 param_count, const rt_accel* accel, const rt_importer* importer,
                           const rt_primitive* primitive = nullptr) {
    return {RT_ABI_VERSION,
            sizeof(rt_plugin),
            RT_TYPES_DIGEST,
            param_count,
            id,
            name,
            version,
            reference,
            params,
            accel,
            importer,
            nullptr,
            sizeof(rt_param),
            sizeof(rt_extension),
            primitive};
}
}  // namespace detail

template <size_t N>
constexpr rt_plugin accel_plugin(const char* id, const char* name, const char* version, const char* reference,
                                 const rt_param (&params)[N], const rt_accel& accel) {
    return detail::plugin(id, name, version, reference, params, N, &accel, nullptr);
}
constexpr rt_plugin accel_plugin(const char* id, const char* name, const char* version, const char* reference,
                                 const rt_accel& accel) {
    return detail::plugin(id, name, version, reference, nullptr, 0, &accel, nullptr);
}
template <size_t N>
constexpr rt_plugin importer_plugin(const char* id, const char* name, const char* version, const char* reference,
                                    const rt_param (&params)[N], const rt_importer& importer) {
    return detail::plugin(id, name, version, reference, params, N, nullptr, &importer);
}
constexpr rt_plugin importer_plugin(const char* id, const char* name, const char* version, const char* reference,
                                    const rt_importer& importer) {
    return detail::plugin(id, name, version, reference, nullptr, 0, nullptr, &importer);
}
constexpr rt_plugin primitive_plugin(const char* id, const char* name, const char* version, const char* reference,
                                     const rt_primitive& primitive) {
    return detail::plugin(id, name, version, reference, nullptr, 0, nullptr, nullptr, &primitive);
}
// The same plugin with extensions: a static array that ends with {nullptr, 0, 0, nullptr}.
template <size_t N>
constexpr rt_plugin with_extensions(rt_plugin plugin, const rt_extension (&extensions)[N]) {
    plugin.extensions = extensions;
    return plugin;
}

}  // namespace rt
