#include "render/accel/build_in_worker.hpp"

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/files/parcel.hpp"
#include "base/physical_memory.hpp"
#include "base/scoped_fp_mode.hpp"
#include "plugin/registry.hpp"
#include "plugin/trust.hpp"
#include "render/accel/guarded_build.hpp"
#include "render/accel/run_builder.hpp"
#include "rt_plugin.h"
#include "scene/shared_array.hpp"
#include "worker/child.hpp"

namespace clarity {
namespace {

// The library of a builder, and its input. The arrays are the caller's, or lie in the parcel.
struct BuildJob {
    std::string library;
    uint64_t memory_bytes = 0;  // that the builder may map
    rt_device device{};
    std::vector<double> params;
    SharedArray<rt_prim> prims;
    SharedArray<rt_group> groups;
    SharedArray<rt_packed_prim> triangles;
    // The tree that is to be packed; no node: none.
    SharedArray<rt_topology_node> nodes;
    SharedArray<rt_u32> refs, roots;

    BuildJob() = default;
    BuildJob(std::string library_file, uint64_t memory, const rt_build_input& input, uint64_t prim_count, rt_u32 param_count,
             const rt_topology* tree);
    template <class Parcel, class Self>
    static void visit(Parcel& parcel, Self& self) {
        parcel(self.library, self.memory_bytes, self.device, self.params, self.prims, self.groups, self.triangles, self.nodes,
               self.refs, self.roots);
    }
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

BuildJob::BuildJob(std::string library_file, uint64_t memory, const rt_build_input& input, uint64_t prim_count,
                   rt_u32 param_count, const rt_topology* tree)
    : library(std::move(library_file)),
      memory_bytes(memory),
      device(*input.device),
      params(input.params, input.params + param_count),
      prims(borrowed(input.prims, prim_count)),
      groups(borrowed(input.groups, input.group_count)) {
    if (input.geometry) triangles = borrowed(input.geometry->triangles, input.geometry->triangle_count);
    if (!tree) return;
    nodes = borrowed(tree->nodes, tree->node_count);
    refs = borrowed(tree->refs, tree->ref_count);
    roots = borrowed(tree->roots, tree->group_count);
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

// The work of kBuildJob.
void build_job(ParcelReader& arguments) {
    const auto job = worker::arguments_in<BuildJob>(arguments);
    const PluginRecord record = load_plugin(job.library);
    if (!record.plugin || !record.plugin->accel)
        throw Error(Exit::failed, "the library is no structure any more: " + record.why);
    const rt_plugin& plugin = *record.plugin;
    const auto groups = static_cast<rt_u32>(job.groups.size());
    BuilderInput input(job.prims.data(), job.prims.size(), job.groups.data(), groups, job.triangles.data(),
                       job.triangles.size(), job.params, job.device);
    if (!job.nodes.empty())
        input.set_tree({sizeof(rt_topology), groups, job.nodes.data(), job.nodes.size(), job.refs.data(), job.refs.size(),
                        job.roots.data()});
    worker::WorkerLimits limits;
    limits.memory_bytes = limits.most_memory_bytes = job.memory_bytes;
    worker::enter_sandbox(worker::WorkerKind::builder, {}, {}, limits);

    worker::ChannelProgress progress;
    HostServices services({}, progress);  // without a name: the program says which builder it is
    GuardedOutput output(plugin, groups, services);
    const rt_build_input& table = input.table();
    services.check(static_cast<int>(Exit::failed), [&] {
        const ScopedFpMode floats;
        return run_builder(plugin, services.host(), &table, input.tree(), output.table());
    });
    const std::string overrun = overrun_of(output.result());
    if (!overrun.empty())
        throw Error(Exit::failed, "the builder wrote beyond the end of " + overrun + "; this is a fault of the plugin");
    worker::answer(BuildAnswer{output.result()});
}

int32_t build_in_worker(const rt_plugin& plugin, const std::string& library, const rt_host* host, const rt_build_input* input,
                        const rt_topology* tree, const rt_build_output* out, Progress& progress) {
    uint64_t prims = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g)
        prims = std::max<uint64_t>(prims, uint64_t(input->groups[g].first) + input->groups[g].count);
    const uint64_t memory = physical_memory_bytes() / 4 * 3;
    worker::Job job(kBuildJob, std::string("accel ") + plugin.id, {30 + double(prims) / 20000, 0, memory});
    job.advice = "; this is a fault of the plugin: `clarity check " + original_of(library) + "` looks for it";
    job.subject = library;
    BuildReplay replay{built_slots(plugin), input->group_count, *out};
    try {
        job.run(BuildJob(library, memory, *input, prims, plugin.param_count, tree), replay, progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        return host->fail(host->ctx, e.what());
    }
    return RT_OK;
}

}  // namespace

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
