// kernel_source.hpp -- one source string for one specialisation of a kernel: shared types, lanes, primitives, the generated
// context, the plugin's traversal as a template, and the kernel. kernel_table.hpp says what each kernel consists of.
#pragma once
#include <string>

#include "render/kernels/kernel_table.hpp"

namespace clarity {

struct Prepared;

struct KernelSource {
    const KernelRow* row = nullptr;
    std::string text, options;
    std::string what;              // for messages: "tracer iterative with accel bvh2"
    bool limit_registers = false;  // a GPU gains by fewer registers than the kernel would take
};
// The kernel that answers `kind` for a scene, structure and settings that were prepared: Prepared's scene, accel, settings and
// layout must be set, its program need not. Throws Error(kernel_build_failed) if a file of it cannot be read.
KernelSource kernel_for(const Prepared& prepared, KernelKind kind, FramePart part = FramePart::whole);

}  // namespace clarity
