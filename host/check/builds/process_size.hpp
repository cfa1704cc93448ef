// process_size.hpp -- how much this process holds, to find leaks.
#pragma once
#include <cstdint>

namespace clarity::check {

struct ProcessSize {
    uint64_t heap_bytes = 0;    // allocated and not freed
    uint64_t mapped_bytes = 0;  // of the address space, beyond the heap
    uint64_t files = 0, threads = 0;
};
// The heap is counted as a whole only if malloc has one arena: call use_one_arena() before threads start.
ProcessSize process_size();
void use_one_arena();

}  // namespace clarity::check
