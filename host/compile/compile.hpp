// compile.hpp -- compiles kernels so that a compiler that hangs, crashes or takes all memory never harms this process.
//
// A program is compiled in a worker process (host/worker), if compiles_in_worker(), and the host loads the binary that the
// worker gives. Programs that were compiled once are known on disk (program_store.hpp), and need no worker. A driver that gives
// no binary compiles a second time in this process, where it did no harm in the worker.
//
// Where the compiler crashes, a warning says so, and the program is compiled without the compiler's optimiser.
#pragma once
#include <string>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "device/pocl_cache.hpp"
#include "device/program.hpp"

namespace clarity {

struct CompileRequest {
    std::string source, options;
    std::string what;  // for messages, such as "tracer iterative with accel bvh2"
};

// Compiles a program for `device`. progress: cancels the compilation within 0.1 s.
// Throws Error(kernel_build_failed) as build_program() does, also if the compiler crashes or needs too much memory, and
// Cancelled. For any thread.
BuildResult compile_program(Device& device, const CompileRequest& request, Progress& progress);

// Does what can be done without this process's context, so that compile_program() finds the program on disk. Use it on another
// thread, for a program that is needed later. Throws Cancelled; all other failures are left to compile_program().
void compile_ahead(const DeviceInfo& info, const CompileRequest& request, Progress& progress);

}  // namespace clarity
