// memory_text.hpp -- amounts of memory as text.
#pragma once
#include <cstdint>
#include <string>

namespace clarity {

// "12.3 GiB", "512 MiB", "1.5 MiB".
std::string memory_text(uint64_t bytes);

}  // namespace clarity
