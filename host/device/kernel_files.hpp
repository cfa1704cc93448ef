// kernel_files.hpp -- the text of kernel sources: embedded in the program, overridden by files on disk.
#pragma once
#include <string>

namespace clarity {

// `name` is relative to cl/ ("tracers/iterative.cl"). CLARITY_KERNEL_PATH names a folder laid out as cl/ whose files come
// first. Throws Error(kernel_build_failed) if there is no such text.
std::string kernel_text(const std::string& name);

// A plugin's own text: CLARITY_KERNEL_PATH/../plugins/accel/<id>/<name> if it is there, else the embedded one.
std::string plugin_kernel_text(const std::string& id, const char* name, const char* embedded);

}  // namespace clarity
