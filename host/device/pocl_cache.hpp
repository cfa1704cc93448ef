// pocl_cache.hpp -- the folder into which PoCL compiles, POCL_CACHE_DIR.
//
// PoCL trusts what it finds there: it aborts the process on a damaged file, and if the folder cannot be written, every build
// fails with "OpenCL error -11". So where programs are compiled in workers, PoCL gets a folder of this process's own, empty at
// first and gone at the end. What is worth keeping is in the program store, with checksums (compile/program_store.hpp).
#pragma once
#include <string>

namespace clarity {

// Where programs are compiled: in a worker, or in this process if CLARITY_COMPILE is `here`, and always inside a worker.
bool compiles_in_worker();

// The folder that PoCL compiles into; empty: it is not known.
std::string pocl_cache();
// Whether that is a folder of this process's own.
bool has_own_pocl_cache();

// Sees to it that PoCL has a folder to compile into, by setting POCL_CACHE_DIR: one of this process's own, below
// POCL_CACHE_DIR, the folder of temporary files or the program's cache folder. Where programs are compiled in this process it
// is PoCL's usual one, or another if that cannot be written, which the returned warning says. Call it once, before a driver is
// loaded and while no other thread reads the environment.
std::string prepare_pocl_cache();

}  // namespace clarity
