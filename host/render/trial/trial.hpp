// trial.hpp -- kernels that were edited, or that a stranger's plugin brings, run in a worker process before they run here.
//
// On a CPU no launch can be stopped, and a kernel that reads out of bounds ends the process that launches it. So the worker
// builds the structure over a small scene (trial_scene.hpp), puts its buffers between guard pages, compiles the kernels with
// their checks of stacks, and traces a small frame with a limit of time. Kernels that pass are known by their text, on disk
// too: $XDG_CACHE_HOME/clarity/tried_kernels. The kernels of shapes are not tried: `clarity check` does that.
#pragma once
#include "base/progress.hpp"
#include "device/device.hpp"
#include "render/frame/prepared.hpp"
#include "render/kernels/kernel_source.hpp"

namespace clarity {

// A Preparer's stage in which a program is launched for the first time, on one pixel.
inline constexpr const char* kFirstLaunchStage = "launching kernels for the first time";

struct Trial {
    const KernelSource& source;
    const Prepared& prepared;  // needs no program
    const DeviceInfo& info;
};

// Tries the kernels if they are not the program's own and have not passed before. CLARITY_TRIAL is `off` (never) or `on` (on
// all devices). Unset: on CPUs, if programs are compiled in a worker (compile.hpp); a GPU's driver ends kernels that run for
// too long, and the trial has not been tried there. Never inside a worker. Throws Error(kernel_build_failed), which says what
// failed and in which files, and Cancelled. For any thread.
void try_kernels(const Trial& trial, Progress& progress);

// Main function of the worker (`clarity trial-worker ...`, which people do not call).
int trial_worker_main(int argc, char** argv);

}  // namespace clarity
