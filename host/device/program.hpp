// program.hpp -- compiles kernels with the device's compiler, and reads its log.
#pragma once
#include <CL/opencl.hpp>
#include <string>

#include "base/error.hpp"
#include "device/device.hpp"

namespace clarity {

// A compiled program.
struct BuildResult {
    cl::Program program;
    double ms = 0;
    std::string log;  // warnings, if any
};

// Compiles `source`. Throws Error(kernel_build_failed). Its message begins with the place of the first error,
// "/home/me/clarity/cl/tracers/camera.h:12:5: ..."; location() holds the same in parts, and details() the whole log. Files read
// from disk are named by their paths.
// what: a description for the message, such as "tracer iterative with accel bvh2".
BuildResult build_program(Device& device, const std::string& source, const std::string& options, const std::string& what);

// The error that build_program() throws. code: OpenCL's; log: the compiler's.
Error build_error(const DeviceInfo& info, const std::string& what, int code, const std::string& log);

// A compiler's log in one form. Compilers derived from clang (PoCL, Intel, AMD, NVIDIA) write "cl/a.cl:3:9: error: text", PoCL
// also "error: cl/a.cl:3:9: text". All lines get the first form, with paths in place of names. Lines that only count errors are
// removed.
struct CompilerLog {
    std::string text;
    SourceLocation first;  // of the first error; without a file if the log names none
    unsigned errors = 0;
};
// Reads a compiler's log.
CompilerLog read_compiler_log(const std::string& log);

}  // namespace clarity
