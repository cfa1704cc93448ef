// program.hpp -- compiling kernels: one source string, the device's compiler, its log.
#pragma once
#include <CL/opencl.hpp>
#include <string>

#include "base/error.hpp"
#include "device/device.hpp"

namespace clarity {

struct BuildResult {
    cl::Program program;
    double ms = 0;
    std::string log;  // warnings, if any
};

// Throws Error(kernel_build_failed). The message begins with the place of the first error,
// "/home/me/clarity/cl/tracers/camera.h:12:5:
// ...", which location() holds in parts; details() is the whole log. Files read from disk are named by their path.
// what: for the message, "tracer iterative with accel bvh2".
BuildResult build_program(Device& device, const std::string& source, const std::string& options, const std::string& what);

// A compiler's log as a person reads it. Compilers that came from clang (PoCL, Intel, AMD, NVIDIA) write "cl/a.cl:3:9: error:
// text", PoCL "error: cl/a.cl:3:9: text"; all is brought to the first form, with paths for names, without the lines that only
// count.
struct CompilerLog {
    std::string text;
    SourceLocation first;  // of the first error; of no file if the log names none
    unsigned errors = 0;
};
CompilerLog read_compiler_log(const std::string& log);

}  // namespace clarity
