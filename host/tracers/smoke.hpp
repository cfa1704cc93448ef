// smoke.hpp -- first launches of kernels: on one pixel, before a program makes frames, and in the worker that tries it.
#pragma once
#include "tracers/tracer.hpp"

namespace clarity {

// A Preparer's stage in which a program is launched for the first time, on one pixel.
inline constexpr const char* kFirstLaunchStage = "launching kernels for the first time";

// Runs the program of `prepared` on one pixel. PoCL compiles a kernel when it first runs with a work-group size, so the first
// frame would wait for the compiler. A queue of its own lets frames continue meanwhile. Throws Error and cl::Error.
void launch_first(const std::shared_ptr<Device>& device, const std::shared_ptr<const Prepared>& prepared);

// Parts of trials, which tracers call.
constexpr double kCompileLimit_s = 3600, kRunLimit_s = 4;  // of processor time. A small frame takes a few milliseconds
// Compiles a program, which the driver then has in its cache. Returns the limit for its first run: it may generate code, or
// compile once more.
double compile_first(const Smoke& smoke, const KernelRow& row);
// Throws Error(kernel_build_failed) if it is not 0.
void expect_room_on_stacks(uint64_t overflowed, const std::string& meanwhile);
// The trial of a tracer of frames: one pixel, then a small frame.
void smoke_frames(const Tracer& tracer, const Smoke& smoke);

}  // namespace clarity
