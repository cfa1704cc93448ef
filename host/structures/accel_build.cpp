// accel_build.cpp -- runs a builder, then checks and packs what it wrote.
#include "structures/accel_build.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "base/problem.hpp"
#include "base/scoped_fp_mode.hpp"
#include "base/timeline.hpp"
#include "plugin/host_services.hpp"
#include "structures/topology_check.hpp"

namespace clarity {
namespace {

constexpr uint64_t kLeafChunk = 1u << 10;  // leaves that one task copies
constexpr uint64_t kLeavesAhead = 24;      // how many leaves ahead triangles are prefetched

// Copies the primitives in leaf order. Returns what is wrong with the refs; empty: nothing.
Problem pack_leaves(const AlignedBytes& refs_in_order, AccelData& data) {
    data.leaves = AlignedBytes((data.leaf_count + kLeafPadding) * sizeof(rt_packed_prim), false);
    const rt_u32* refs = static_cast<const rt_u32*>(refs_in_order.data());
    rt_packed_prim* leaves = static_cast<rt_packed_prim*>(data.leaves.data());
    const rt_packed_prim* const triangles = data.scene.triangles.data();
    std::memset(leaves + data.leaf_count, 0, kLeafPadding * sizeof(rt_packed_prim));
    constexpr uint64_t none = ~uint64_t(0);
    std::atomic<uint64_t> first_unknown{none};
    parallel_for(static_cast<uint32_t>((data.leaf_count + kLeafChunk - 1) / kLeafChunk), [&](uint32_t c) {
        const uint64_t end = std::min<uint64_t>(data.leaf_count, (c + 1) * kLeafChunk);
        for (uint64_t i = c * kLeafChunk; i < end; ++i) {
            // Neighbouring leaves are close in the scene, but may be anywhere in memory.
            const rt_u32 ahead = refs[std::min(i + kLeavesAhead, end - 1)];
            if (RT_REF_KIND(ahead) == RT_REF_TRIANGLE) __builtin_prefetch(triangles + RT_REF_INDEX(ahead));
            if (!is_known_ref(refs[i], data.scene)) {
                uint64_t first = first_unknown;
                while (i < first && !first_unknown.compare_exchange_weak(first, i)) {
                }
                return;
            }
            const rt_u32 index = RT_REF_INDEX(refs[i]);
            switch (RT_REF_KIND(refs[i])) {
                case RT_REF_TRIANGLE:
                    leaves[i] = triangles[index];
                    break;
                case RT_REF_SPHERE:
                    leaves[i] = data.scene.spheres[index];
                    break;
                case RT_REF_POLYGON:
                    leaves[i] = data.scene.polygons[index];
                    break;
                case RT_REF_SHAPE:
                    leaves[i] = data.scene.shape_leaves[index];
                    break;
                default:
                    leaves[i] = data.scene.instance_leaves[index];
            }
        }
    });
    return first_unknown == none ? "" : "put a ref at leaf " + std::to_string(first_unknown) + " that it was not given";
}

std::string name_of(const rt_plugin& plugin, const rt_plugin& layout) {
    return &plugin == &layout ? std::string("accel ") + plugin.id
                              : std::string("accel ") + layout.id + ", which packs the tree of " + plugin.id;
}

Error fault(const std::string& speaker, const std::string& why) {
    return Error(Exit::failed, speaker + ": the builder " + why + "; this is a fault of the plugin");
}

struct HostBuild {
    BuilderResultIn<AlignedBytes> result;
    double ms = 0;
};

// Runs `call` on an output for the slots of `plugin`. Throws what build_accel() throws, except for wrong refs.
template <class Call>
HostBuild run_build(const rt_plugin& plugin, const std::string& speaker, rt_u32 group_count, Progress& progress, Call&& call) {
    HostServices services(speaker, progress);
    // A buffer of a device must not be empty, so each slot has memory for one element at least.
    BuilderOutput<AlignedBytes> out(built_slots(plugin), group_count, services,
                                    [](uint64_t count, size_t element_bytes, const std::string&) {
                                        return AlignedBytes(std::max<uint64_t>(count, 1) * element_bytes, true);
                                    });
    const auto start = std::chrono::steady_clock::now();
    services.check(static_cast<int>(Exit::failed), [&] {
        const ScopedFpMode floats;
        return call(services.host(), out.table());
    });
    HostBuild built{std::move(out.result()), ms_since(start)};
    if (const Problem why = built.result.breach(plugin)) throw fault(speaker, why.text());
    return built;
}

}  // namespace

double AccelFacts::stat(const std::string& label, double otherwise) const {
    for (const auto& [name, value] : stats)
        if (name == label) return value;
    return otherwise;
}

rt_device device_for_builders(const DeviceInfo& info, unsigned lanes) {
    rt_device device = unknown_device();
    device.kind = info.cpu ? RT_DEVICE_CPU : info.gpu ? RT_DEVICE_GPU : RT_DEVICE_UNKNOWN;
    device.lanes = lanes;
    device.compute_units = info.compute_units;
    device.cache_line_bytes = info.cache_line_bytes;
    device.local_bytes = static_cast<rt_u32>(std::min<uint64_t>(info.local_bytes, UINT32_MAX));
    device.shared_cache_bytes = info.cache_bytes;
    device.memory_bytes = info.global_bytes;
#ifdef _SC_LEVEL2_CACHE_SIZE
    // OpenCL tells only of one cache. A CPU's cores have their second level for themselves.
    if (info.cpu) device.unit_cache_bytes = static_cast<uint64_t>(std::max(0L, sysconf(_SC_LEVEL2_CACHE_SIZE)));
#endif
    return device;
}

AccelData build_accel(const Scene& scene, const rt_plugin& plugin, const ParameterValues& params, Progress& progress,
                      const BuildTarget& target) {
    const rt_plugin& layout = target.layout ? *target.layout : plugin;
    if (!layout.accel->build)
        throw Error(Exit::failed, std::string("accel ") + plugin.id + ": it builds a topology, and its layout '" +
                                      plugin.accel->layout + "' is not there to pack it; load that plugin, too");
    const timeline::Scope span("build", [&] { return std::string("build ") + plugin.id; });
    AccelData data;
    data.plugin = &plugin;
    data.layout = &layout;
    data.params = params;
    auto start = std::chrono::steady_clock::now();
    data.scene = make_build_scene(scene, progress);
    data.pack_ms = ms_since(start);

    const bool packs = &layout != &plugin;
    const ParameterValues own = packs ? default_parameters(layout) : params;
    const rt_geometry geometry{sizeof(rt_geometry), data.scene.triangles.data(), data.scene.triangles.size()};
    rt_build_input input{};
    input.struct_bytes = sizeof input;
    input.group_count = static_cast<rt_u32>(data.scene.groups.size());
    input.prims = data.scene.prims.data();
    input.groups = data.scene.groups.data();
    input.geometry = &geometry;
    input.params = params.data();
    input.device = &target.device;

    HostBuild built = run_build(plugin, name_of(plugin, plugin), input.group_count, progress,
                                [&](const rt_host* host, const rt_build_output* out) {
                                    return call_builder(plugin, target.place, host, &input, nullptr, out, progress);
                                });
    data.build_ms = built.ms;
    if (packs) {
        start = std::chrono::steady_clock::now();
        if (const Problem why = topology_fault(topology_of(built.result), data.scene))
            throw fault(name_of(plugin, plugin), why.text());
        data.pack_ms += ms_since(start);
        data.stats = built.result.stats;
        const HostBuild tree = std::move(built);
        const rt_topology topology = topology_of(tree.result);
        input.params = own.data();
        built = run_build(layout, name_of(plugin, layout), input.group_count, progress,
                          [&](const rt_host* host, const rt_build_output* out) {
                              return call_builder(layout, target.place, host, &input, &topology, out, progress);
                          });
        data.build_ms += built.ms;
    }
    data.scene.prims = {};  // frees what is no longer needed at once: large scenes fill the memory with it

    start = std::chrono::steady_clock::now();
    take_result(built.result, data, [](AlignedBytes& memory) { return std::move(memory); });
    if (const Problem why = pack_leaves(built.result.refs, data)) throw fault(name_of(plugin, layout), why.text());
    built.result = {};
    data.scene.triangles = {};
    data.pack_ms += ms_since(start);
    return data;
}

}  // namespace clarity
