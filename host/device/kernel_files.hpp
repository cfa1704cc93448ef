// kernel_files.hpp -- where the text of kernels comes from.
//
// The first place that has a file of that name:
//   1. CLARITY_KERNEL_PATH, a folder laid out as cl/, with plugins/accel/<id>/ beside it; alone, 2 and 3 are then not looked
//   at.
//      "embedded" names no folder but the text inside the program.
//   2. the checkout, if the program stands in a build folder inside it (<checkout>/build/bin, <checkout>/build/release/bin), so
//      that an edit counts without a build
//   3. for a plugin's file: beside the plugin's library
//   4. the text inside the program or plugin
// A header that host and kernels share must be what the program was compiled with, or nothing is taken from disk: structs that
// differ would be traced as garbage.
//
// Messages name files as the compiler is told them: "cl/tracers/iterative.cl", "plugins/accel/bvh2/bvh2.cl".
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

// `name` is relative to cl/ ("tracers/iterative.cl"). Throws Error(kernel_build_failed) if there is no such text, or if
// rt_types.h on disk is not the program's.
std::string kernel_text(const std::string& name);

// A plugin's own file. Throws Error(kernel_build_failed) if its types on disk are not those that it was compiled with.
std::string plugin_kernel_text(const rt_plugin& accel, const rt_cl_file& file);
// What the compiler is told that file is called.
std::string plugin_kernel_name(const rt_plugin& accel, const rt_cl_file& file);

// The path behind a name in a compiler's message, once its text was read from disk; else "".
std::string kernel_path(const std::string& shown_name);

// Grows whenever a text differs from the one read before under that name: programs made earlier are of older texts.
uint64_t kernel_text_revision();

// Every path on disk that decides a text now or would if it came into being; for FileWatch. Empty if only embedded text counts.
std::vector<std::string> kernel_candidates(const std::vector<const rt_plugin*>& accels);

}  // namespace clarity
