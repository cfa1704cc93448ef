// program_store.hpp -- programs that were compiled once, on disk: $XDG_CACHE_HOME/clarity/programs, one file for each.
//
// A file holds the binary that the driver gave, or nothing, which says that this program compiles and ends. Checksums are
// verified before a driver sees the content: PoCL aborts the process on a damaged one. Files appear whole or not at all, so
// that any number of processes may share the folder. The folder holds at most kStoreBytes; what was used least recently goes
// first. No loaded program reads a file here: PoCL unpacks its binary into a folder of the process's own
// (device/pocl_cache.hpp), where it stays as it is until the process ends. CLARITY_PROGRAM_CACHE names another folder, or is
// `off`: then none outlives the process.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/device.hpp"

namespace clarity {

inline constexpr uint64_t kStoreBytes = uint64_t{256} << 20;

// Names a program of a device: its source, options, device, versions of driver and platform, and what variables tell PoCL.
std::string program_key(const DeviceInfo& info, const std::string& source, const std::string& options);

// Whether there is a folder for programs.
bool keeps_programs();

// Any thread may use these. A store that cannot be read or written is an empty one.
// nullopt: the program is not known.
std::optional<std::vector<char>> find_program(const std::string& key);
void keep_program(const std::string& key, const std::vector<char>& binary, uint64_t most_bytes = kStoreBytes);
void forget_program(const std::string& key);
// Between these two calls the program is not known. A process that dies while its driver loads a program, because the driver's
// own cache is damaged, so leaves the next one to try it in a worker first.
void set_aside(const std::string& key);
void put_back(const std::string& key);

}  // namespace clarity
