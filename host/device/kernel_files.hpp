// kernel_files.hpp -- where the text of kernels comes from.
//
// The first of these places that has a file of that name is used:
//   1. CLARITY_KERNEL_PATH: a folder with the layout of cl/, with plugins/accel/<id>/ and plugins/primitives/<id>/
//      beside it. If it is set, places 2 to 4 are not used. The value "embedded" means place 5.
//   2. for a plugin's file: the sources that its library was built from, if they are still there. Note: <library>.sources
//   3. the checkout, if the program is in a build folder inside it (<checkout>/build/bin, <checkout>/build/release/bin)
//   4. for a plugin's file: the folder of the plugin's library. A file that is older than the library and differs from the text
//      in it is not used; a warning says so
//   5. the text inside the program or plugin
// So an edit takes effect without a build. A text of place 2 or 4 that differs from the one in the library is logged.
// A header that host and kernels share must be equal to the one that the program was compiled with. If it is not, this is an
// error, because kernels would read wrong structs.
//
// Messages name files as the compiler does: "cl/tracers/iterative/iterative.cl", "plugins/accel/bvh2/bvh2.cl". All functions
// are thread-safe.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "rt_plugin.h"

namespace clarity {

// Returns the text of a file; `name` is relative to cl/ ("tracers/iterative/iterative.cl"). Throws Error(kernel_build_failed)
// if there is no such text, or if rt_types.h or rt_shared.h on disk differ from the program's.
std::string kernel_text(const std::string& name);

// Returns the names of all files of cl/ that are inside the program, in a fixed order.
std::vector<std::string> kernel_names();

// Returns the text of a plugin's file, with the files that it includes (kernel_includes.hpp). Throws Error(kernel_build_failed)
// if its types on disk differ from those that it was compiled with, or if a file that it includes cannot be read.
std::string plugin_kernel_text(const rt_plugin& plugin, const rt_cl_file& file);
// What the compiler is told that file is called.
std::string plugin_kernel_name(const rt_plugin& plugin, const rt_cl_file& file);

// Returns the path of a name in a compiler's message if its text was read from disk; else "".
std::string kernel_path(const std::string& shown_name);

// What to call it in messages: its path, "my_tree.cl inside /home/me/my_tree.so" for a text that is in a plugin, or the name
// itself.
std::string kernel_place(const std::string& shown_name);

// A number that grows whenever a text differs from the last one read under that name. Programs made before are then out of
// date.
uint64_t kernel_text_revision();

// A text in force that differs from the one inside the program or its library.
struct EditedKernel {
    std::string shown_name;  // as in the program's text
    std::string path;
    unsigned line;  // the first that differs; 0: one of the files that it includes differs
};
// Those among the texts that were last read, in the order of their names.
std::vector<EditedKernel> edited_kernels();

// Returns every path that provides a text now, or would if the file existed; for FileWatch. Empty if only embedded text counts.
// The parts of a plugin are those that its files include at the time of the call.
std::vector<std::string> kernel_candidates(const std::vector<const rt_plugin*>& plugins);

}  // namespace clarity
