// program_store.hpp -- programs that were compiled once, on disk: $XDG_CACHE_HOME/clarity/programs, one file for each.
//
// A file holds the binary that the driver gave, or what PoCL has compiled, or nothing, which says that this
// program compiles and ends. Checksums are verified before a driver sees the content: PoCL aborts the process on a damaged one.
// Files appear whole or not at all, so that any number of processes may share the folder. The folder holds at most kStoreBytes;
// what was used least recently goes first. CLARITY_PROGRAM_CACHE names another folder, or is `off`.
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

// What PoCL has compiled of a program, for programs that PoCL is slow to give a binary of.
//
// PoCL compiles a kernel when it is first launched with a local size. For a binary it also compiles forms that no launch uses,
// which takes as long again (compile_job.cpp). In its cache a program is a folder, its entry: XX/NAME/program.bc and, once
// launched, XX/NAME/KERNEL/FORM/KERNEL.so. Entries come into the cache of this process from a worker or from the program store,
// and go from there to the store at the end of the process, because only then all launches are known. Thread-safe.

// A folder for a worker to compile one program into; empty: PoCL has no cache of this process's own.
std::string folder_for_worker();
// Takes the entry that a worker has written there, and removes the folder. key: the program's, in the store.
void take_entry(const std::string& key, const std::string& folder);
void drop_folder(const std::string& folder);

// Whether this process has the entry of a program.
bool has_entry(const std::string& key);
// Puts an entry from the store into the cache. Returns false if these bytes are none.
bool unpack_entry(const std::string& key, const std::vector<char>& stored);

}  // namespace clarity
