// physical_memory.hpp -- how much memory the machine has.
#pragma once
#include <unistd.h>

#include <cstdint>

namespace clarity {

// In bytes, of all programs together.
inline uint64_t physical_memory_bytes() {
    return static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace clarity
