#include "render/accel/build_in_worker.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "base/files/library_files.hpp"
#include "base/log.hpp"
#include "base/physical_memory.hpp"
#include "base/printable.hpp"
#include "plugin/known_libraries.hpp"
#include "render/accel/builder_wire.hpp"
#include "render/accel/run_builder.hpp"
#include "worker/child.hpp"
#include "worker/supervisor.hpp"

namespace clarity {
namespace {

// The file of the library that a plugin is in; empty: it is part of this program. `plugin` is a copy, its texts are the
// library's.
std::string library_of(const rt_plugin& plugin) {
    std::error_code error;
    const std::filesystem::path library = std::filesystem::canonical(loaded_file_of(plugin.id), error);
    if (error || library == program_file()) return {};
    return library.string();
}

uint64_t physical_bytes() {
    return physical_memory_bytes();
}

class BuildSupervisor : public worker::Supervisor {
 public:
    BuildSupervisor(worker::WorkerProcess& process, const rt_plugin& plugin, const std::string& library, uint64_t prims,
                    uint64_t memory_bytes, Progress& progress)
        : Supervisor(process, {worker::kBuildGreeting, "a build worker", worker::worker_program(), Exit::failed}, progress),
          plugin_(plugin),
          library_(library),
          idle_s_(30 + double(prims) / 20000),
          memory_bytes_(memory_bytes) {}

 private:
    double idle_limit_s() const override { return idle_s_; }
    bool counts_processor_time() const override { return true; }
    uint64_t processor_limit_s() const override { return 0; }
    uint64_t memory_limit_bytes() const override { return memory_bytes_; }
    std::string speaker() const override { return std::string("accel ") + plugin_.id; }
    void printed(const std::string& line) override { log(LogLevel::info, speaker() + " printed: " + printable_line(line)); }
    void ended(const worker::Ending& ending) const override {
        using End = worker::Ending::Kind;
        const std::string advice =
            "; this is a fault of the plugin: `clarity check " + original_of(library_) + "` looks for it";
        switch (ending.kind) {
            case End::crashed:
                throw Error(Exit::failed, "the builder crashed (" + ending.how + ")" + advice);
            case End::exited:
                throw Error(Exit::failed, "the builder ended its process (" + ending.how + ") instead of returning" + advice);
            case End::no_progress:
                throw Error(Exit::failed, "the builder made no progress for " + ending.how + " and was stopped" + advice);
            case End::memory:
                throw Error(Exit::failed,
                            "the builder needs more than " + ending.how + " of memory; take a smaller scene" + advice);
            default:
                throw Error(Exit::failed,
                            "the builder's process was killed from outside; close other programs or take a smaller scene");
        }
    }
    const rt_plugin& plugin_;
    const std::string library_;
    const double idle_s_;
    const uint64_t memory_bytes_;
};

int32_t build_in_worker(const rt_plugin& plugin, const std::string& library, const rt_host* host, const rt_build_input* input,
                        const rt_topology* tree, const rt_build_output* out, Progress& progress) {
    uint64_t prims = 0;
    for (rt_u32 g = 0; g < input->group_count; ++g)
        prims = std::max<uint64_t>(prims, uint64_t(input->groups[g].first) + input->groups[g].count);
    const uint64_t memory = physical_bytes() / 4 * 3;
    try {
        worker::WorkerProcess process(
            worker::worker_program(), "build-worker",
            {"--library", library, "--memory", std::to_string(memory), "--parent", std::to_string(getpid())}, Exit::failed);
        std::string why = write_builder_input(process.result().fd(), *input, prims, plugin.param_count, tree);
        if (!why.empty()) throw Error(Exit::failed, why);
        worker::send_message(process.channel(), {worker::MessageKind::proceed, 0, 0, {}});
        BuildSupervisor(process, plugin, library, prims, memory, progress).follow();
        process.kill_now();
        process.wait();
        why = replay_builder_result(process.result().fd(), built_slots(plugin), input->group_count, *out);
        if (!why.empty()) throw Error(Exit::failed, why);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& e) {
        return host->fail(host->ctx, e.what());
    }
    return RT_OK;
}

}  // namespace

int32_t call_builder(const rt_plugin& plugin, BuildPlace place, const rt_host* host, const rt_build_input* input,
                     const rt_topology* tree, const rt_build_output* out, Progress& progress) {
    const std::string library = place == BuildPlace::here || std::getenv(worker::kWorkerVariable) ? "" : library_of(plugin);
    if (library.empty() || (place == BuildPlace::automatic && is_known_library(library)))
        return run_builder(plugin, host, input, tree, out);
    const int32_t status = build_in_worker(plugin, library, host, input, tree, out, progress);
    if (status == RT_OK) remember_library(library);
    return status;
}

}  // namespace clarity
