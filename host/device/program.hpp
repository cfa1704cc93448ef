// program.hpp -- compiling kernels: one source string, the device's compiler, its log.
#pragma once
#include <CL/opencl.hpp>
#include <string>

#include "device/device.hpp"

namespace clarity {

struct BuildResult {
    cl::Program program;
    double ms = 0;
    std::string log;  // warnings, if any
};

// Throws Error(kernel_build_failed): the first error line in the message ("bvh2.cl:12:5: ..."), the whole log in details().
// what: for the message, "tracer iterative with accel bvh2".
BuildResult build_program(Device& device, const std::string& source, const std::string& options, const std::string& what);

}  // namespace clarity
