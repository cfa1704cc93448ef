// kernel_source.hpp -- makes the source of one specialisation of a kernel: shared types, lanes, primitives, the generated
// context, the plugin's traversal as a template, and the kernel. kernel_row.hpp says what the parts of a kernel are.
#pragma once
#include <string>

#include "kernels/kernel_arguments.hpp"
#include "kernels/kernel_row.hpp"
#include "kernels/layout.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

struct KernelSource {
    const KernelRow* row = nullptr;  // must outlive this
    std::string text, options;
    std::string what;              // for messages: "tracer iterative with accel bvh2"
    bool limit_registers = false;  // limit the kernel's registers on GPUs: it is faster with fewer than it would take
    std::string declarations;      // where the kernels of the program are declared
    ArgumentMacros macros;         // of these declarations
};
// Returns the source of a kernel for this scene in this structure. Throws Error(kernel_build_failed) if a file of the kernel
// cannot be read.
KernelSource kernel_for(const KernelRow& row, const Settings& settings, const Layout& layout, const Scene& scene,
                        const AccelData& accel);

}  // namespace clarity
