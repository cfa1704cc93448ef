// known_libraries.hpp -- which plugin libraries may run in this process at once: our own, and those that have come to an end
// before.
#pragma once
#include <string>

namespace clarity {

// True for a library in the program's own plugin folder, and for one with the content of a library that remember_library() was
// told about, in this process or an earlier one ($XDG_CACHE_HOME/clarity/known_plugins). Thread-safe; reads the file.
bool is_known_library(const std::string& path);
void remember_library(const std::string& path);

}  // namespace clarity
