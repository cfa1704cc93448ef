// trial.hpp -- kernels that were edited, or that a stranger's plugin brings, run in a worker process before they run here.
//
// On a CPU no launch can be stopped, and a kernel that reads out of bounds ends the process that launches it. So the worker
// builds the structure over a small scene (tools/trial), puts its buffers between guard pages, compiles the kernels
// with their checks of stacks, and runs them with a limit of time: as their tracer says (Tracer::smoke), or the film. Kernels
// that pass are known by their text, on disk too (base/files/cache_folder.hpp).
#pragma once
#include <memory>

#include "base/progress.hpp"
#include "kernels/program_cache.hpp"
#include "launch/prepared.hpp"

namespace clarity {

// Compiles a program for `prepared`, which needs none yet, and tries its kernels if they have not passed before, and are not
// the program's own or are compiled by Mesa's llvmpipe. The setting `trial` is `off` (never), `on` (on all devices) or `auto`:
// on CPUs, if programs are compiled in a worker (compile.hpp); what runs for too long on a GPU is given up there
// (launch_limit.hpp). Never inside a worker.
// fresh: as ProgramCache::get(). Throws Error(kernel_build_failed), which says what failed and in which files, and Cancelled.
std::shared_ptr<TraceProgram> tried_program(ProgramCache& programs, const Prepared& prepared, const KernelRow& row,
                                            Progress& progress, bool* fresh = nullptr);

// The same for the film's program, which is not compiled here. For any thread.
void try_film(const DeviceInfo& info, const Settings& settings, Progress& progress);

}  // namespace clarity
