// builder_output.hpp -- runs a builder, and receives what it writes, in memory of either kind: plain, or between guard pages.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "base/problem.hpp"
#include "plugin/host_services.hpp"
#include "plugin/plugin_check.hpp"
#include "rt_plugin.h"

namespace clarity {

// Calls the builder of any kind of structure in one way: one with slots, one that builds a topology, or one
// that packs the topology of another.

// The slots that a plugin's builder fills: the structure's own; of a topology one, its nodes.
const rt_accel& built_slots(const rt_plugin& plugin);

// Calls build(); with a tree, pack(). Of a topology it calls topology(): the nodes are slot 0 of `out`, the refs its leaves. A
// root may be RT_NONE then. tree: of another builder, for the same input; may be nullptr. On the calling thread; returns the
// plugin's status.
int32_t run_builder(const rt_plugin& plugin, const rt_host* host, const rt_build_input* input, const rt_topology* tree,
                    const rt_build_output* out);

// What a builder wrote. Bytes: AlignedBytes or GuardedBytes.
template <class Bytes>
struct BuilderResultIn {
    struct Slot {
        Bytes memory;
        uint64_t count = 0;
        bool allocated = false;
    };
    std::vector<Slot> slots;
    Bytes refs;  // rt_u32 in leaf order
    uint64_t leaf_count = 0;
    bool leaves_given = false;
    std::vector<rt_u32> roots;  // one for each group
    std::vector<bool> rooted;
    std::map<std::string, rt_u32> defines;
    std::vector<std::pair<std::string, double>> stats;  // in the builder's order

    // How the builder of `plugin` broke its contract, in its terms: "never asked for the leaves"; empty: it did not. Refs are
    // not checked.
    Problem breach(const rt_plugin& plugin) const {
        const rt_accel& accel = built_slots(plugin);
        const bool topology = plugin.accel->topology != nullptr;
        for (size_t s = 0; s < slots.size(); ++s)
            if (!slots[s].allocated)
                return std::string(topology ? "never asked for " : "never allocated slot ") + accel.slots[s].name;
        if (!leaves_given) return topology ? "never asked for refs" : "never asked for the leaves";
        for (size_t g = 0; g < roots.size(); ++g) {
            if (!rooted[g]) return "reported no root for group " + std::to_string(g);
            // topology_fault() looks at the roots of a topology, which may be RT_NONE.
            if (!topology && roots[g] >= slots[0].count)
                return "reported root " + std::to_string(roots[g]) + " for group " + std::to_string(g) + ", but slot " +
                       accel.slots[0].name + " has " + std::to_string(slots[0].count) + " elements";
        }
        return {};
    }
};

// The functions of rt_build_output. They are thread-safe. A call that breaks the contract fails the build. `accel` and
// `services` must outlive it. allocate: makes zeroed memory, or throws std::bad_alloc.
template <class Bytes>
class BuilderOutput {
 public:
    using Allocate = Bytes (*)(uint64_t count, size_t element_bytes, const std::string& name);
    BuilderOutput(const rt_accel& accel, rt_u32 group_count, HostServices& services, Allocate allocate)
        : accel_(accel), group_count_(group_count), services_(services), allocate_(allocate) {
        result_.slots.resize(accel.slot_count);
        result_.roots.assign(group_count, 0);
        result_.rooted.assign(group_count, false);
        table_.struct_bytes = sizeof table_;
        table_.ctx = this;
        table_.alloc = [](void* ctx, rt_u32 slot, uint64_t count) { return self(ctx).alloc(slot, count); };
        table_.leaves = [](void* ctx, uint64_t count) { return self(ctx).leaves(count); };
        table_.root = [](void* ctx, rt_u32 group, rt_u32 node) { self(ctx).root(group, node); };
        table_.define = [](void* ctx, const char* name, rt_u32 value) { self(ctx).define(name, value); };
        table_.stat = [](void* ctx, const char* label, double value) { self(ctx).stat(label, value); };
    }
    BuilderOutput(const BuilderOutput&) = delete;
    BuilderOutput& operator=(const BuilderOutput&) = delete;
    const rt_build_output* table() const { return &table_; }
    BuilderResultIn<Bytes>& result() { return result_; }

 private:
    static constexpr uint64_t kMostBytes = uint64_t(1) << 40;  // of a slot

    static BuilderOutput& self(void* ctx) { return *static_cast<BuilderOutput*>(ctx); }

    void* alloc(rt_u32 slot, uint64_t count) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (slot >= accel_.slot_count)
            return refuse("asked for slot " + std::to_string(slot) + " of " + std::to_string(accel_.slot_count));
        const std::string name = accel_.slots[slot].name;
        auto& out = result_.slots[slot];
        if (out.allocated) return refuse("allocated slot " + name + " twice");
        if (count > kMostBytes / accel_.slots[slot].elem_bytes)
            return refuse("asked for " + std::to_string(count) + " elements of slot " + name);
        out.allocated = true;
        out.count = count;
        return make(out.memory, count, accel_.slots[slot].elem_bytes, "slot " + name, " elements of slot " + name);
    }
    rt_u32* leaves(uint64_t count) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (result_.leaves_given) return static_cast<rt_u32*>(refuse("asked for the leaves twice"));
        if (count > RT_REF_INDEX_MAX) return static_cast<rt_u32*>(refuse("asked for " + std::to_string(count) + " leaves"));
        result_.leaves_given = true;
        result_.leaf_count = count;
        return static_cast<rt_u32*>(make(result_.refs, count, sizeof(rt_u32), "the leaves", " leaves"));
    }
    void root(rt_u32 group, rt_u32 node) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (group >= group_count_) {
            refuse("reported a root for group " + std::to_string(group) + " of " + std::to_string(group_count_));
            return;
        }
        result_.rooted[group] = true;
        result_.roots[group] = node;
    }
    void define(const char* name, rt_u32 value) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (name && (std::strncmp(name, "RT_", 3) == 0 || std::strncmp(name, "rt_", 3) == 0))
            refuse(std::string("gave a define the name '") + name +
                   "', but names that begin so are the host's: take one of your own");
        else if (is_identifier(name))
            result_.defines[name] = value;
        else  // the name becomes a line of the kernel's source
            refuse(std::string("gave a define the name '") + (name ? name : "NULL") + "', which is no identifier");
    }
    void stat(const char* label, double value) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (label)
            result_.stats.emplace_back(label, value);
        else
            refuse("gave a stat no label");
    }
    void* make(Bytes& memory, uint64_t count, size_t element_bytes, const std::string& name, const std::string& what) {
        try {
            memory = allocate_(count, element_bytes, name);
        } catch (const std::bad_alloc&) {
            return refuse("no memory for " + std::to_string(count) + what);
        }
        return memory.data();
    }
    // Fails the build. Returns nullptr.
    void* refuse(const std::string& why) {
        services_.fail("the builder " + why);
        return nullptr;
    }

    const rt_accel& accel_;
    const rt_u32 group_count_;
    HostServices& services_;
    const Allocate allocate_;
    std::mutex mutex_;
    rt_build_output table_{};
    BuilderResultIn<Bytes> result_;
};

}  // namespace clarity
