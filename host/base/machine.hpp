// machine.hpp -- what this machine calls itself, and how much memory it has.
#pragma once
#include <unistd.h>

#include <cstdint>
#include <string>

namespace clarity {

// Digits, letters, dots and hyphens of the machine's name, at most 64 characters; "host" if it has none. For files in folders
// that several machines share.
const std::string& host_name();

// Memory of the machine in bytes, of all programs together.
inline uint64_t physical_memory_bytes() {
    return static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

// Gives the system what is free in the heaps of all threads. Takes some ms. Does nothing where the C library cannot.
void give_free_memory_back();

}  // namespace clarity
