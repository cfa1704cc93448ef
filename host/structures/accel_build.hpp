// accel_build.hpp -- runs the builder of a structure over a scene, and checks and packs what it returns.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/aligned_bytes.hpp"
#include "base/progress.hpp"
#include "device/device.hpp"
#include "plugin/parameters.hpp"
#include "rt_plugin.h"
#include "scene/scene.hpp"
#include "structures/build_in_worker.hpp"
#include "structures/build_scene.hpp"
#include "structures/builder_output.hpp"

namespace clarity {

// Zeroed primitives behind the last leaf, because cl/primitives/triangle_row.h reads RT_ROW leaves from any leaf on.
constexpr uint64_t kLeafPadding = 3;

// What is known of a structure besides its memory.
struct AccelFacts {
    const rt_plugin* plugin = nullptr;
    const rt_plugin* layout = nullptr;  // whose slots and kernels these are: plugin itself, or the layout of its topology
    ParameterValues params;
    std::vector<rt_u32> roots;  // one for each group
    std::map<std::string, rt_u32> defines;
    std::vector<std::pair<std::string, double>> stats;  // as the plugin reported them, in its order
    double build_ms = 0;  // time of the plugin's build() alone, or of topology() and the layout's pack()
    double pack_ms = 0;   // time of the conversion before and of checks and packing after it
    uint64_t bytes = 0;   // size of slots, leaves and instances
    CLARITY_MEMBERS(plugin, layout, params, roots, defines, stats, build_ms, pack_ms, bytes);
    // The plugin's statistic of that label, or `otherwise`.
    double stat(const std::string& label, double otherwise = 0) const;
};

// A finished structure. Immutable.
struct AccelData : AccelFacts {
    struct Slot {
        AlignedBytes memory;
        uint64_t count = 0;
        CLARITY_MEMBERS(memory, count);
    };
    std::vector<Slot> slots;
    AlignedBytes leaves;  // rt_packed_prim in leaf order, then kLeafPadding zeroed ones
    uint64_t leaf_count = 0;
    std::vector<rt_instance> instances;  // with roots
    BuildScene scene;
    template <class Self>
    static auto members(Self& self) {
        using Facts = std::conditional_t<std::is_const_v<Self>, const AccelFacts, AccelFacts>;
        return std::tie(static_cast<Facts&>(self), self.slots, self.leaves, self.leaf_count, self.instances, self.scene);
    }
};

// Moves what a builder wrote into `data`, whose layout and scene are set already, and completes what follows from it: the
// instances' roots and the bytes. take: makes memory of the data of a slot's. The leaves are the caller's to pack.
template <class Bytes, class Take>
void take_result(BuilderResultIn<Bytes>& result, AccelData& data, const Take& take) {
    static_assert(has_member_count<AccelData, 6> && has_member_count<AccelFacts, 9>,
                  "all but the leaves and the times are set here");
    for (auto& slot : result.slots) data.slots.push_back({take(slot.memory), slot.count});
    data.leaf_count = result.leaf_count;
    data.roots = std::move(result.roots);
    data.defines = std::move(result.defines);
    data.stats.insert(data.stats.end(), result.stats.begin(), result.stats.end());
    data.instances = data.scene.instances;
    for (size_t i = 0; i < data.instances.size(); ++i) data.instances[i].root = data.roots[data.scene.group_of_instance[i]];
    data.bytes = data.leaf_count * sizeof(rt_packed_prim) + data.instances.size() * sizeof(rt_instance);
    for (rt_u32 s = 0; s < data.layout->accel->slot_count; ++s)
        if (!(data.layout->accel->slots[s].flags & RT_SLOT_HOST_ONLY))
            data.bytes += data.slots[s].count * data.layout->accel->slots[s].elem_bytes;
}

// Copies the structure. For each slot and for the leaves, memory(bytes of `from`) returns the bytes of the copy: its own copy
// of them, or the same bytes, borrowed.
template <class Memory>
AccelData copy_of(const AccelData& from, Memory&& memory) {
    AccelData copy;
    static_cast<AccelFacts&>(copy) = from;
    for (const AccelData::Slot& slot : from.slots) copy.slots.push_back({memory(slot.memory), slot.count});
    copy.leaves = memory(from.leaves);
    copy.leaf_count = from.leaf_count;
    copy.instances = from.instances;
    copy.scene = from.scene;
    static_assert(has_member_count<AccelData, 6>, "a new member has to be copied here");
    return copy;
}

// What decides about a build besides the plugin, the scene and the parameters.
inline rt_device unknown_device() {
    rt_device device{};
    device.struct_bytes = sizeof device;
    device.kind = RT_DEVICE_UNKNOWN;
    return device;
}
struct BuildTarget {
    const rt_plugin* layout = nullptr;  // PluginRegistry::layout_of(); nullptr: the plugin itself
    rt_device device = unknown_device();
    BuildPlace place = BuildPlace::automatic;
};
// Describes a device to builders. lanes: rays of a work-item.
rt_device device_for_builders(const DeviceInfo& info, unsigned lanes);

// Runs a plugin's builder on a scene, on the calling thread and those that it starts. Throws Error(failed) "accel bvh2: why",
// and Cancelled. It also throws if the builder breaks its contract, for example by a missing root, a root or a ref out of
// range, a slot allocated twice, or an exception. A stranger's builder runs in a worker process: see BuildTarget::place.
AccelData build_accel(const Scene& scene, const rt_plugin& plugin, const ParameterValues& params, Progress& progress,
                      const BuildTarget& target = {});

// Builds the structure of a scene, on any thread.
using AccelBuilder = std::function<std::shared_ptr<const AccelData>(const Scene&, Progress&)>;

}  // namespace clarity
