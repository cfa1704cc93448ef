// library_files.hpp -- which file a loaded library is in, and which file its user knows it as.
//
// Both are the same, except for a library that was rebuilt while the program runs: the dynamic loader knows a file only once,
// so a private copy of the new file is loaded (plugin/library_watch.hpp). All functions are thread-safe.
#pragma once
#include <filesystem>
#include <string>

namespace clarity {

// The file of the program `clarity`. In the program it is the process's own file, or empty if /proc is not mounted. In the
// library it is what set_program_file() was given.
std::filesystem::path program_file();
// For a library. Workers are started from this file, and plugins are found beside it.
void set_program_file(const std::filesystem::path& file);
// Whether set_program_file() was called.
bool is_library();

// Path of the library or program that this constant or function is in, as it was loaded. Empty if no file has it, as for memory
// of the heap.
std::string loaded_file_of(const void* address);

// The same, but empty for what is part of this program, or of the library that this function is in.
std::string library_of(const void* address);

// Notes that `copy` was loaded in the place of `original`.
void note_private_copy(const std::string& copy, const std::string& original);

// The file that a loaded file stands for: the original of a private copy, else the path itself. Absolute; empty for "".
std::string original_of(const std::string& loaded);

}  // namespace clarity
