#include "render/accel/build_in_worker.hpp"

#include <algorithm>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/physical_memory.hpp"
#include "plugin/trust.hpp"
#include "render/accel/build_job.hpp"
#include "render/accel/run_builder.hpp"

namespace clarity {
namespace {

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
