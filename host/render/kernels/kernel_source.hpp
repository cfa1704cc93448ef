// kernel_source.hpp -- makes the source of one specialisation of a kernel: shared types, lanes, primitives, the generated
// context, the plugin's traversal as a template, and the kernel. kernel_table.hpp lists the parts of each kernel.
#pragma once
#include <string>

#include "render/accel/accel_build.hpp"
#include "render/kernels/kernel_table.hpp"
#include "scene/scene.hpp"

namespace clarity {

struct KernelSource {
    const KernelRow* row = nullptr;
    std::string text, options;
    std::string what;              // for messages: "tracer iterative with accel bvh2"
    bool limit_registers = false;  // limit the kernel's registers on GPUs: it is faster with fewer than it would take
};
// Returns the source of the chosen kernel for this scene in this structure. Throws Error(kernel_build_failed) if a file of the
// kernel cannot be read.
KernelSource kernel_for(const KernelChoice& choice, const Scene& scene, const AccelData& accel);

}  // namespace clarity
