// accel_build.cpp -- runs a builder, then checks and packs what it wrote.
#include "render/accel/accel_build.hpp"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <mutex>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/host_services.hpp"
#include "plugin/plugin_check.hpp"
#include "render/accel/topology_build.hpp"

namespace clarity {
namespace {

constexpr uint64_t kSlotLimit = uint64_t(1) << 40;

// Receives what the plugin's builder writes. Its functions are thread-safe.
struct Output {
    const rt_accel& accel;
    AccelData& data;
    HostServices& services;
    rt_u32 group_count;
    std::mutex mutex;
    std::vector<bool> allocated, rooted;
    bool leaves_given = false;

    Output(const rt_accel& a, AccelData& d, HostServices& s, rt_u32 groups)
        : accel(a), data(d), services(s), group_count(groups), allocated(a.slot_count), rooted(groups) {
        data.slots.resize(accel.slot_count);
        data.roots.assign(groups, 0);
    }

    void* alloc(rt_u32 slot, uint64_t count) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (slot >= accel.slot_count)
            return refuse("asked for slot " + std::to_string(slot) + " of " + std::to_string(accel.slot_count));
        const std::string name = accel.slots[slot].name;
        if (allocated[slot]) return refuse("allocated slot " + name + " twice");
        if (count > kSlotLimit / accel.slots[slot].elem_bytes)
            return refuse("asked for " + std::to_string(count) + " elements of slot " + name);
        allocated[slot] = true;
        try {
            data.slots[slot].memory = AlignedBytes(std::max<uint64_t>(count, 1) * accel.slots[slot].elem_bytes, true);
        } catch (const std::bad_alloc&) {
            return refuse("no memory for " + std::to_string(count) + " elements of slot " + name);
        }
        data.slots[slot].count = count;
        return data.slots[slot].memory.data();
    }

    rt_u32* leaves(uint64_t count) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (leaves_given) return static_cast<rt_u32*>(refuse("asked for the leaves twice"));
        if (count > RT_REF_INDEX_MAX) return static_cast<rt_u32*>(refuse("asked for " + std::to_string(count) + " leaves"));
        leaves_given = true;
        try {
            refs = AlignedBytes(std::max<uint64_t>(count, 1) * sizeof(rt_u32), true);
        } catch (const std::bad_alloc&) {
            return static_cast<rt_u32*>(refuse("no memory for " + std::to_string(count) + " leaves"));
        }
        data.leaf_count = count;
        return static_cast<rt_u32*>(refs.data());
    }

    void root(rt_u32 group, rt_u32 node) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (group >= group_count) {
            refuse("reported a root for group " + std::to_string(group) + " of " + std::to_string(group_count));
            return;
        }
        rooted[group] = true;
        data.roots[group] = node;
    }

    // Fails the build. Returns nullptr for alloc() and leaves().
    void* refuse(const std::string& why) {
        services.fail("the builder " + why);
        return nullptr;
    }

    AlignedBytes refs;
};

Output& output(void* ctx) {
    return *static_cast<Output*>(ctx);
}

constexpr uint64_t kLeafChunk = 1u << 10;  // leaves that one task copies
constexpr uint64_t kLeavesAhead = 24;      // how many leaves ahead triangles are prefetched

// Returns how the builder broke its contract, in its terms; empty: it did not. Refs are checked by pack_leaves().
std::string contract_breach(const Output& out) {
    for (rt_u32 s = 0; s < out.accel.slot_count; ++s)
        if (!out.allocated[s]) return std::string("never allocated slot ") + out.accel.slots[s].name;
    if (!out.leaves_given) return "never asked for the leaves";
    for (rt_u32 g = 0; g < out.group_count; ++g) {
        if (!out.rooted[g]) return "reported no root for group " + std::to_string(g);
        if (out.data.roots[g] >= out.data.slots[0].count)
            return "reported root " + std::to_string(out.data.roots[g]) + " for group " + std::to_string(g) + ", but slot " +
                   out.accel.slots[0].name + " has " + std::to_string(out.data.slots[0].count) + " elements";
    }
    return {};
}

// Copies the primitives in leaf order. Returns what is wrong with the refs; empty: nothing.
std::string pack_leaves(const Output& out, AccelData& data) {
    data.leaves = AlignedBytes((data.leaf_count + kLeafPadding) * sizeof(rt_packed_prim), false);
    const rt_u32* refs = static_cast<const rt_u32*>(out.refs.data());
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
                default:
                    leaves[i] = data.scene.instance_leaves[index];
            }
        }
    });
    return first_unknown == none ? "" : "put a ref at leaf " + std::to_string(first_unknown) + " that it was not given";
}

}  // namespace

double AccelData::stat(const std::string& label, double otherwise) const {
    for (const auto& [name, value] : stats)
        if (name == label) return value;
    return otherwise;
}

namespace {

rt_build_output table_of(Output& out) {
    rt_build_output table{};
    table.struct_bytes = sizeof table;
    table.ctx = &out;
    table.alloc = [](void* ctx, rt_u32 slot, uint64_t count) { return output(ctx).alloc(slot, count); };
    table.leaves = [](void* ctx, uint64_t count) { return output(ctx).leaves(count); };
    table.root = [](void* ctx, rt_u32 group, rt_u32 node) { output(ctx).root(group, node); };
    table.define = [](void* ctx, const char* name, rt_u32 value) {
        const std::lock_guard<std::mutex> lock(output(ctx).mutex);
        if (is_identifier(name))
            output(ctx).data.defines[name] = value;
        else  // the name becomes a line of the kernel's source
            output(ctx).refuse(std::string("gave a define the name '") + (name ? name : "NULL") + "', which is no identifier");
    };
    table.stat = [](void* ctx, const char* label, double value) {
        const std::lock_guard<std::mutex> lock(output(ctx).mutex);
        if (label)
            output(ctx).data.stats.emplace_back(label, value);
        else
            output(ctx).refuse("gave a stat no label");
    };
    return table;
}

std::string name_of(const rt_plugin& plugin, const rt_plugin& layout) {
    return &plugin == &layout ? std::string("accel ") + plugin.id
                              : std::string("accel ") + layout.id + ", which packs the tree of " + plugin.id;
}

}  // namespace

rt_device device_for_builders(const DeviceInfo& info, unsigned lanes) {
    rt_device device{};
    device.struct_bytes = sizeof device;
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
    TopologyData topology;
    if (packs) topology = build_topology(data.scene, plugin, input, progress, data.stats);
    data.pack_ms += topology.check_ms;
    input.params = own.data();

    HostServices services(name_of(plugin, layout), progress);
    Output out(*layout.accel, data, services, input.group_count);
    const rt_build_output output_table = table_of(out);
    const rt_topology tree = topology.view();
    start = std::chrono::steady_clock::now();
    services.check(static_cast<int>(Exit::failed), [&] {
        const ScopedFpMode floats;
        return packs ? layout.accel->pack(services.host(), &input, &tree, &output_table)
                     : layout.accel->build(services.host(), &input, &output_table);
    });
    data.build_ms = topology.build_ms + ms_since(start);
    topology = {};
    data.scene.prims = {};  // frees what is no longer needed at once: large scenes fill the memory with it

    start = std::chrono::steady_clock::now();
    std::string why = contract_breach(out);
    if (why.empty()) why = pack_leaves(out, data);
    if (!why.empty())
        throw Error(Exit::failed, name_of(plugin, layout) + ": the builder " + why + "; this is a fault of the plugin");
    out.refs = {};
    data.scene.triangles = {};
    data.instances = data.scene.instances;
    for (size_t i = 0; i < data.instances.size(); ++i) data.instances[i].root = data.roots[data.scene.group_of_instance[i]];
    data.bytes = data.leaf_count * sizeof(rt_packed_prim) + data.instances.size() * sizeof(rt_instance);
    for (rt_u32 s = 0; s < layout.accel->slot_count; ++s)
        if (!(layout.accel->slots[s].flags & RT_SLOT_HOST_ONLY))
            data.bytes += data.slots[s].count * layout.accel->slots[s].elem_bytes;
    data.pack_ms += ms_since(start);
    return data;
}

}  // namespace clarity
