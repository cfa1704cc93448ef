// kernel_includes.hpp -- `#include` lines in a plugin's kernels.
//
// An OpenCL program is one string, so its compiler finds no files. The host therefore puts the text of a file in the place of
// the line that includes it. #line directives around it make the compiler name the file and the line that an author sees.
//
// A file may include
//   "bvh8_node.h"                   a part of the plugin, which lies beside the file
//   "cl/lanes/packet_traversal.h"   a file of cl/
// A line counts if it begins with #include and has nothing behind the name. A file is inserted as often as it is included.
// clarity_embed() (cmake/embed_text.cmake) inserts the parts of a plugin in the same way when the plugin is built, so the text
// inside a plugin has only lines of the second kind left.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace clarity {

// Returns the text of an included file. `name` is as it was written.
using ReadInclude = std::function<std::string(const std::string& name)>;

enum class IncludeKind {
    part,   // "bvh8_node.h"
    kernel  // "cl/..."
};

// `text` with its includes of one kind replaced, those of included files too. `shown` is the name of the text in compiler
// messages; an included part has the same folder. Throws Error(kernel_build_failed) where files include each other in a circle,
// or where a name is of neither kind.
std::string expand_includes(const std::string& text, const std::string& shown, IncludeKind kind, const ReadInclude& read);

// The names of the parts that a text includes by itself, in order.
std::vector<std::string> included_parts(const std::string& text);

}  // namespace clarity
