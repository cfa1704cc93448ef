// zero_launch.hpp -- launches the kernels of a program once on buffers of zeros. PoCL compiles a kernel when it is first
// launched with a work-group size: this compiles it without a scene.
#pragma once
#include "device/device.hpp"

namespace clarity {

// All kernels must end at once on zeros. Their arguments must be known: the program was compiled with -cl-kernel-arg-info.
// Kernels without a required work-group size are launched with 64 work-items, as FilmKernels does. Throws cl::Error.
void launch_on_zeros(Device& device, const cl::Program& program);

}  // namespace clarity
