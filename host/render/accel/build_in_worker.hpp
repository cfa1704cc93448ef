// build_in_worker.hpp -- runs the builders of strangers' libraries in a worker process, so that a crash is one message.
#pragma once
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

extern const worker::JobKind kBuildJob;

}  // namespace clarity
