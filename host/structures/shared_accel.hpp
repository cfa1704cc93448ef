// shared_accel.hpp -- a finished structure in a file in memory, so that the processes of a host share one copy of it.
#pragma once
#include <memory>

#include "base/files/memory_file.hpp"
#include "plugin/registry.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

// Writes a structure into an empty file, and seals it. Throws Error(failed).
void write_accel(MemoryFile& file, const AccelData& accel);

// The structure of a file that write_accel() of the same program wrote. Its slots and leaves lie in the file. Throws
// Error(failed) if the file holds none, or if its plugin is not there.
std::shared_ptr<const AccelData> map_accel(const MemoryFile& file, const PluginRegistry& plugins);

}  // namespace clarity
