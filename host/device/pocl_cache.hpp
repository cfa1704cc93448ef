// pocl_cache.hpp -- PoCL compiles only into its cache folder. If that cannot be written, every build fails with "OpenCL error
// -11".
#pragma once
#include <string>

namespace clarity {

// The folder that PoCL compiles into; empty: it is not known.
std::string pocl_cache();

// Sees to it that PoCL has a folder to compile into: its own, or else one below the program's cache folder or that of temporary
// files, by setting POCL_CACHE_DIR. Returns a warning if its own cannot be used. Call it before a driver is loaded and while no
// other thread reads the environment.
std::string use_writable_pocl_cache();

}  // namespace clarity
