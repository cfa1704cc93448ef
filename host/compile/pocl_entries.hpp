// pocl_entries.hpp -- what PoCL has compiled of a program, for programs that PoCL is slow to give a binary of.
//
// PoCL compiles a kernel when it is first launched with a local size. For a binary it also compiles forms that no launch uses,
// which takes as long again (pocl_forms.hpp). In its cache a program is a folder, its entry: XX/NAME/program.bc and, once
// launched, XX/NAME/KERNEL/FORM/KERNEL.so. Entries come into the cache of this process from a worker or from the program store,
// and go from there to the store at the end of the process, because only then all launches are known. Thread-safe.
#pragma once
#include <string>
#include <vector>

namespace clarity {

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
