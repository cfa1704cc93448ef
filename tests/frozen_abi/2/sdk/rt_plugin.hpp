// rt_plugin.hpp -- of the C++ helpers of version 2 those that the plugins of this folder use, as they were.
#pragma once
#include <exception>
#include <new>
#include <string>

#include "rt_plugin.h"

namespace rt {
struct Stopped : std::exception {
    const char* what() const noexcept override { return "stopped by the host"; }
};
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
            return host->fail(host->ctx, "out of memory");
        } catch (const std::exception& e) {
            return host->fail(host->ctx, e.what());
        } catch (...) {
            return host->fail(host->ctx, "an exception of unknown type");
        }
    }
};

}  // namespace detail
template <auto F>
inline constexpr auto guarded = &detail::Guard<F>::call;
[[nodiscard]] inline Stopped fail(const rt_host* host, const std::string& why) {
    host->fail(host->ctx, why.c_str());
    return {};
}
inline void progress(const rt_host* host, float fraction) {
    if (!host->progress(host->ctx, fraction)) throw Cancelled();
}

constexpr rt_param float_param(const char* key, const char* label, const char* help, double min, double max, double def,
                               int32_t effect = RT_EFFECT_REBUILD) {
    return {key, label, help, RT_PARAM_FLOAT, effect, min, max, def, nullptr};
}
struct Traits {
    rt_u32 capabilities = 0;
    float merit_cpu = 0, merit_gpu = 0;
    rt_u32 ray_cost = RT_RAY_COST_LOGARITHMIC;
};

using BuildTopology = int32_t (*)(const rt_host*, const rt_build_input*, const rt_topology_output*);
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
inline rt_topology_node* nodes(const rt_topology_output* out, uint64_t count) {
    rt_topology_node* memory = out->nodes(out->ctx, count);
    if (!memory) throw Stopped();
    return memory;
}
inline rt_u32* refs(const rt_topology_output* out, uint64_t count) {
    rt_u32* memory = out->refs(out->ctx, count);
    if (!memory) throw Stopped();
    return memory;
}
inline void root(const rt_topology_output* out, rt_u32 group, rt_u32 node) {
    out->root(out->ctx, group, node);
}
constexpr rt_material_desc material(const char* name = nullptr) {
    return {sizeof(rt_material_desc), 0, name, {0.7f, 0.7f, 0.7f}, 0, {0, 0, 0}, 0, {0.15f, 0.15f, 0.15f}, 32, 1.5f, RT_NONE};
}
constexpr rt_light_desc light(rt_u32 kind, const char* name = nullptr) {
    return {sizeof(rt_light_desc), kind, name, {0, 0, 0}, {0, -1, 0}, {1, 1, 1}, 0};
}
inline rt_u32 id(rt_u32 answer) {
    if (answer == RT_NONE) throw Stopped();
    return answer;
}

namespace detail {
constexpr rt_plugin plugin(const char* id, const char* name, const char* version, const char* reference, const rt_param* params,
                           rt_u32 param_count, const rt_accel* accel, const rt_importer* importer) {
    return {RT_ABI_VERSION,   sizeof(rt_plugin),   RT_TYPES_DIGEST, param_count, id,       name,
            version,          reference,           params,          accel,       importer, nullptr,
            sizeof(rt_param), sizeof(rt_extension)};
}
}  // namespace detail

constexpr rt_plugin accel_plugin(const char* id, const char* name, const char* version, const char* reference,
                                 const rt_accel& accel) {
    return detail::plugin(id, name, version, reference, nullptr, 0, &accel, nullptr);
}
template <size_t N>
constexpr rt_plugin importer_plugin(const char* id, const char* name, const char* version, const char* reference,
                                    const rt_param (&params)[N], const rt_importer& importer) {
    return detail::plugin(id, name, version, reference, params, N, nullptr, &importer);
}
}  // namespace rt
