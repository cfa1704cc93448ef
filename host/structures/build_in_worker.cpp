#include "structures/build_in_worker.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/parcel.hpp"
#include "base/machine.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/host_services.hpp"
#include "plugin/parameters.hpp"
#include "plugin/registry.hpp"
#include "plugin/trust.hpp"
#include "rt_plugin.h"
#include "scene/shared_array.hpp"
#include "structures/builder_output.hpp"
#include "structures/guarded_build.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

// The library of a builder, and its input. The arrays are the caller's, or lie in the parcel.
struct BuildJob {
    std::string library;
    uint64_t memory_bytes = 0;  // that the builder may map
    uint64_t cpu_s = 0;  // processor time of the whole job; not 0: the library is opened behind closed doors, and built twice
    rt_device device{};
    std::vector<double> params;
    SharedArray<rt_prim> prims;
    SharedArray<rt_group> groups;
    SharedArray<rt_packed_prim> triangles;
    // The tree that is to be packed; no node: none.
    SharedArray<rt_topology_node> nodes;
    SharedArray<rt_u32> refs, roots;

    CLARITY_MEMBERS(library, memory_bytes, cpu_s, device, params, prims, groups, triangles, nodes, refs, roots);
};

// What a builder wrote, in the worker; in the program it calls the functions of `out` as the builder did. The worker is not
// trusted: every size is checked.
struct BuildReplay {
    const rt_accel& accel;
    rt_u32 group_count;
    const rt_build_output& out;
    static void visit(ParcelReader& parcel, BuildReplay& replay);
};

struct BuildAnswer {
    const BuilderResult& result;
    static void visit(ParcelWriter& parcel, const BuildAnswer& answer);
};

template <class T>
SharedArray<T> borrowed(const T* data, uint64_t count) {
    return SharedArray<T>::borrow(nullptr, data, count);
}

// An array that comes next, as memory that `ask` gives; elements of element_bytes.
template <class Ask>
void read_array(ParcelReader& parcel, bool wanted, uint64_t count, uint64_t element_bytes, const char* what, const Ask& ask) {
    const uint64_t bytes = parcel.begin_array();
    if (bytes % element_bytes != 0 || bytes / element_bytes != (wanted ? count : 0)) throw ParcelDamaged();
    void* const memory = wanted ? ask() : nullptr;
    if (wanted && !memory) throw Error(Exit::failed, std::string("no memory for ") + what);
    parcel.take(memory, bytes);
}

BuildJob job_of(std::string library, const rt_build_input& input, uint64_t prim_count, rt_u32 param_count,
                const rt_topology* tree) {
    BuildJob job;
    job.library = std::move(library);
    job.device = *input.device;
    job.params.assign(input.params, input.params + param_count);
    job.prims = borrowed(input.prims, prim_count);
    job.groups = borrowed(input.groups, input.group_count);
    if (input.geometry) job.triangles = borrowed(input.geometry->triangles, input.geometry->triangle_count);
    if (!tree) return job;
    job.nodes = borrowed(tree->nodes, tree->node_count);
    job.refs = borrowed(tree->refs, tree->ref_count);
    job.roots = borrowed(tree->roots, tree->group_count);
    return job;
}

void BuildAnswer::visit(ParcelWriter& parcel, const BuildAnswer& answer) {
    const BuilderResult& result = answer.result;
    parcel(result.rooted, result.roots, result.defines, result.stats);
    for (const BuilderResult::Slot& slot : result.slots) {
        parcel(slot.allocated, slot.count);
        parcel.bytes(slot.memory.data(), slot.allocated ? slot.memory.bytes() : 0);
    }
    parcel(result.leaves_given, result.leaf_count);
    parcel.bytes(result.refs.data(), result.leaves_given ? result.refs.bytes() : 0);
}

void BuildReplay::visit(ParcelReader& parcel, BuildReplay& replay) {
    const rt_build_output& out = replay.out;
    std::vector<bool> rooted;
    std::vector<rt_u32> roots;
    std::map<std::string, rt_u32> defines;
    std::vector<std::pair<std::string, double>> stats;
    parcel(rooted, roots, defines, stats);
    if (rooted.size() != replay.group_count || roots.size() != replay.group_count) throw ParcelDamaged();
    for (rt_u32 g = 0; g < replay.group_count; ++g)
        if (rooted[g]) out.root(out.ctx, g, roots[g]);
    for (const auto& [name, value] : defines) out.define(out.ctx, name.c_str(), value);
    for (const auto& [label, value] : stats) out.stat(out.ctx, label.c_str(), value);
    bool given = false;
    uint64_t count = 0;
    for (rt_u32 s = 0; s < replay.accel.slot_count; ++s) {
        parcel(given, count);
        read_array(parcel, given, count, replay.accel.slots[s].elem_bytes, "a slot",
                   [&] { return out.alloc(out.ctx, s, count); });
    }
    parcel(given, count);
    read_array(parcel, given, count, sizeof(rt_u32), "the leaves",
               [&] { return static_cast<void*>(out.leaves(out.ctx, count)); });
}

bool is_same(const BuilderResult& a, const BuilderResult& b) {
    const auto same = [](const GuardedBytes& x, const GuardedBytes& y) {
        return x.bytes() == y.bytes() && (x.bytes() == 0 || std::memcmp(x.data(), y.data(), x.bytes()) == 0);
    };
    bool all = a.roots == b.roots && same(a.refs, b.refs) && a.slots.size() == b.slots.size();
    for (size_t s = 0; all && s < a.slots.size(); ++s) all = same(a.slots[s].memory, b.slots[s].memory);
    return all;
}

// The work of kBuildJob.
void build_job(ParcelReader& arguments) {
    auto job = worker::arguments_in<BuildJob>(arguments);
    worker::WorkerLimits limits;
    limits.memory_bytes = limits.most_memory_bytes = job.memory_bytes;
    limits.cpu_s = job.cpu_s;
    const bool closed = job.cpu_s > 0;
    if (closed)
        worker::enter_sandbox(worker::WorkerKind::loader, {"/lib", "/lib64", "/usr/lib", "/usr/local/lib"},
                              {"/etc/ld.so.cache", program_file().string(), job.library}, limits);
    const PluginRecord record = load_plugin(job.library);
    if (!record.plugin || !record.plugin->accel)
        throw Error(Exit::failed, "the library is no structure any more: " + record.why);
    const rt_plugin& plugin = *record.plugin;
    const auto groups = static_cast<rt_u32>(job.groups.size());
    if (closed) job.params = default_parameters(plugin);  // the program does not know them
    BuilderInput input(job.prims.data(), job.prims.size(), job.groups.data(), groups, job.triangles.data(),
                       job.triangles.size(), job.params, job.device);
    if (!job.nodes.empty())
        input.set_tree({sizeof(rt_topology), groups, job.nodes.data(), job.nodes.size(), job.refs.data(), job.refs.size(),
                        job.roots.data()});
    worker::enter_sandbox(worker::WorkerKind::builder, {}, {}, limits);

    worker::ChannelProgress progress;
    HostServices services({}, progress);  // without a name: the program says which builder it is
    const rt_build_input& table = input.table();
    const auto build = [&](GuardedOutput& output) {
        services.check(static_cast<int>(Exit::failed), [&] {
            const ScopedFpMode floats;
            return run_builder(plugin, services.host(), &table, input.tree(), output.table());
        });
        const std::string overrun = overrun_of(output.result());
        if (!overrun.empty())
            throw Error(Exit::failed, "the builder wrote beyond the end of " + overrun + "; this is a fault of the plugin");
    };
    GuardedOutput output(plugin, groups, services);
    build(output);
    if (closed) {
        // Each build has a process of its own, so that a state that it keeps would not be seen there.
        GuardedOutput again(plugin, groups, services);
        build(again);
        if (!is_same(output.result(), again.result()))
            throw Error(Exit::failed,
                        "the builder gives another result for the same scene when it is called again: it keeps state")
                .as(Failure::keeps_state);
    }
    worker::answer(BuildAnswer{output.result()});
}

uint64_t prim_count_of(const rt_build_input& input) {
    uint64_t prims = 0;
    for (rt_u32 g = 0; g < input.group_count; ++g)
        prims = std::max<uint64_t>(prims, uint64_t(input.groups[g].first) + input.groups[g].count);
    return prims;
}

int32_t build_in_worker(const rt_plugin& plugin, const std::string& library, const rt_host* host, const rt_build_input* input,
                        const rt_topology* tree, const rt_build_output* out, Progress& progress) {
    const uint64_t prims = prim_count_of(*input);
    const uint64_t memory = physical_memory_bytes() / 4 * 3;
    worker::Job job(kBuildJob, std::string("accel ") + plugin.id, {30 + double(prims) / 20000, 0, memory});
    job.advice = "; this is a fault of the plugin: `clarity check " + original_of(library) + "` looks for it";
    job.subject = library;
    BuildReplay replay{built_slots(plugin), input->group_count, *out};
    BuildJob work = job_of(library, *input, prims, plugin.param_count, tree);
    work.memory_bytes = memory;
    try {
        job.run(work, replay, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        return HostServices::fail(host, e);
    }
    return RT_OK;
}

// A build behind closed doors. What the library prints reaches nobody, and neither sleep nor reports of progress make it last.
class ClosedBuild : public worker::Job {
 public:
    ClosedBuild(const ClosedBuilder& builder)
        : Job(kBuildJob, "a builder", {builder.limit_s, cpu_s_of(builder), builder.memory_bytes}),
          most_s_(kWaits * builder.limit_s) {}
    static uint64_t cpu_s_of(const ClosedBuilder& builder) { return static_cast<uint64_t>(std::ceil(2 * builder.limit_s)); }

 private:
    static constexpr double kWaits = 6;  // times the limit of processor time, for a busy machine
    void on_output(const std::string&) override {}
    void watch() override {
        if (seconds_since(begin_) > most_s_)
            throw Error(kind_.code, "the builder did not come to its end within " + worker::in_words(most_s_))
                .as(Failure::endless);
    }
    const double most_s_;
    const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

ClosedBuilder closed_builder;

// Builds, and hands over what was built. slots: those of the output.
int32_t build_closed(const rt_host* host, const rt_build_input* input, const rt_accel& slots, const rt_build_output& out) {
    BuildJob work = job_of(closed_builder.library, *input, prim_count_of(*input), 0, nullptr);
    work.memory_bytes = closed_builder.memory_bytes;
    work.cpu_s = ClosedBuild::cpu_s_of(closed_builder);
    BuildReplay replay{slots, input->group_count, out};
    Progress progress;
    ClosedBuild job(closed_builder);
    job.subject = closed_builder.library;
    try {
        job.run(work, replay, progress);
    } catch (const Error& e) {
        return HostServices::fail(host, e);
    }
    return RT_OK;
}

int32_t build_closed_tree(const rt_host* host, const rt_build_input* input, const rt_topology_output* to) {
    rt_build_output out{};
    out.struct_bytes = sizeof out;
    out.ctx = const_cast<rt_topology_output*>(to);
    const auto of = [](void* ctx) -> const rt_topology_output& { return *static_cast<const rt_topology_output*>(ctx); };
    static constexpr auto output = +of;
    out.alloc = [](void* ctx, rt_u32, uint64_t count) -> void* { return output(ctx).nodes(output(ctx).ctx, count); };
    out.leaves = [](void* ctx, uint64_t count) { return output(ctx).refs(output(ctx).ctx, count); };
    out.root = [](void* ctx, rt_u32 group, rt_u32 node) { output(ctx).root(output(ctx).ctx, group, node); };
    out.stat = [](void* ctx, const char* label, double value) { output(ctx).stat(output(ctx).ctx, label, value); };
    out.define = [](void*, const char*, rt_u32) {};
    rt_accel slots{};
    slots.topology = build_closed_tree;
    rt_plugin plugin{};
    plugin.accel = &slots;
    return build_closed(host, input, built_slots(plugin), out);
}

rt_accel closed_accel{};  // of take_closed_builder()

int32_t build_closed_slots(const rt_host* host, const rt_build_input* input, const rt_build_output* to) {
    rt_build_output out = *to;
    out.define = [](void*, const char*, rt_u32) {};  // a define could change what kernels count
    return build_closed(host, input, closed_accel, out);
}

}  // namespace

const rt_plugin* take_closed_builder(const ClosedBuilder& builder) {
    static rt_plugin plugin{};
    rt_accel& accel = closed_accel;
    closed_builder = builder;
    if (!builder.table.empty()) {
        const PluginRecord record = load_plugin(builder.table);
        if (!record.plugin || !record.plugin->accel || !record.plugin->accel->build)
            throw Error(Exit::failed, builder.table + ": is no structure with slots: " + record.why);
        plugin = *record.plugin, accel = *record.plugin->accel;
        accel.build = build_closed_slots;
        plugin.accel = &accel;
        return &plugin;
    }
    accel.struct_bytes = sizeof accel;
    accel.layout = closed_builder.layout.c_str();
    accel.topology = build_closed_tree;
    plugin.abi_version = RT_ABI_VERSION;
    plugin.struct_bytes = sizeof plugin;
    plugin.id = plugin.name = closed_builder.id.c_str();
    plugin.version = "";
    plugin.accel = &accel;
    return &plugin;
}

const worker::JobKind kBuildJob = {
    "build",
    "to build a structure, run `clarity render`",
    Exit::failed,
    true,
    LogLevel::info,
    {"the builder crashed ({how}){advice}", "the builder ended its process ({how}) instead of returning{advice}",
     "the builder made no progress for {how} and was stopped{advice}",
     "the builder used more than {how} of processor time{advice}",
     "the builder needs more than {how} of memory; take a smaller scene{advice}",
     "the builder's process was killed from outside; close other programs or take a smaller scene"},
    build_job};

int32_t call_builder(const rt_plugin& plugin, BuildPlace place, const rt_host* host, const rt_build_input* input,
                     const rt_topology* tree, const rt_build_output* out, Progress& progress) {
    const std::string library = place == BuildPlace::here || worker::in_worker() ? "" : library_of(plugin.id);
    if (library.empty() || (place == BuildPlace::automatic && trust_of(library) != Trust::none))
        return run_builder(plugin, host, input, tree, out);
    const int32_t status = build_in_worker(plugin, library, host, input, tree, out, progress);
    if (status == RT_OK) remember_library(library);
    return status;
}

}  // namespace clarity
