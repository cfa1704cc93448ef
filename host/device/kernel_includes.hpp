// kernel_includes.hpp -- `#include` lines in a plugin's kernels.
//
// An OpenCL program is one string, so its compiler finds no files. The host therefore replaces each line that includes a file
// by the file's text. #line directives around the text make compiler messages name the author's file and line.
//
// A file may include
//   "bvh8_node.h"                   a part of the plugin, in the same folder
//   "cl/lanes/packet_traversal.h"   a file of cl/
// A line counts if it begins with #include and has nothing behind the name. A file is inserted as often as it is included.
// clarity_embed() (cmake/embed_text.cmake) inserts the parts of a plugin in the same way when the plugin is built, so the text
// inside a plugin has only lines of the second kind left.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace clarity {

// Returns the text of an included file. name: as in the #include line.
using ReadInclude = std::function<std::string(const std::string& name)>;

enum class IncludeKind {
    part,   // "bvh8_node.h"
    kernel  // "cl/..."
};

// Returns `text` with its includes of one kind replaced, also those of included files. shown: the name of the text in compiler
// messages; included parts are in the same folder. Throws Error(kernel_build_failed) if files include each other in a circle,
// or if a name is of neither kind.
std::string expand_includes(const std::string& text, const std::string& shown, IncludeKind kind, const ReadInclude& read);

// Returns the names of the parts that the text itself includes, in order.
std::vector<std::string> included_parts(const std::string& text);

}  // namespace clarity
