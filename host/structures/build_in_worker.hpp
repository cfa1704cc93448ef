// build_in_worker.hpp -- runs the builders of strangers' libraries in a worker process, so that a crash is one message.
#pragma once
#include <cstdint>
#include <string>

#include "base/progress.hpp"
#include "rt_plugin.h"
#include "worker/job.hpp"

namespace clarity {

// Where builders run.
enum class BuildPlace {
    automatic,  // in a worker where the plugin's library has no trust (plugin/trust.hpp), else here
    worker,     // always in a worker, on memory between guard pages: for --debug
    here
};

// Calls run_builder() with these arguments, here or in a worker process, where a crash, an endless loop or a call of exit
// ends only the worker. Same result and same meaning. Throws Cancelled. progress: the one behind `host`.
int32_t call_builder(const rt_plugin& plugin, BuildPlace place, const rt_host* host, const rt_build_input* input,
                     const rt_topology* tree, const rt_build_output* out, Progress& progress);

// A library that builds, behind closed doors: no process but a worker for each build ever opens it, and that one has no files,
// no network and no other programs from its first instruction on. For graders.
struct ClosedBuilder {
    std::string library, id, layout;  // id and layout: what the library must be; what it says of itself is not asked
    // A library that is trusted: its slots and kernels count. "": `library` builds topologies for `layout`.
    std::string table;
    double limit_s = 10;  // processor time of a build
    uint64_t memory_bytes = uint64_t(1) << 30;
    CLARITY_MEMBERS(library, id, layout, table, limit_s, memory_bytes);
};
// The plugin that stands for it in this process, also if this is a worker. One a process.
const rt_plugin* take_closed_builder(const ClosedBuilder& builder);

extern const worker::JobKind kBuildJob;

}  // namespace clarity
