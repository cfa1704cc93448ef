// memory_text.hpp -- amounts of memory as text.
#pragma once
#include <cstdint>
#include <string>

namespace clarity {

// "12.3 GiB", "512 MiB", "1.5 MiB".
std::string memory_text(uint64_t bytes);
// Limits, in whole units: "12 GiB", "512 MiB", "100 bytes" (below one MiB, because "0 MiB" would not help).
std::string memory_limit_text(uint64_t bytes);

}  // namespace clarity
