// process_size.hpp -- how much this process holds, to find leaks.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "tools/check/steps.hpp"

namespace clarity::check {

struct ProcessSize {
    uint64_t heap_bytes = 0;    // allocated and not freed
    uint64_t mapped_bytes = 0;  // of the address space, beyond the heap
    uint64_t files = 0, threads = 0;
};
// The heap is counted as a whole only if malloc has one arena: call use_one_arena() before threads start.
ProcessSize process_size();
void use_one_arena();

// Does something `times` times, after 20 times in which caches fill, and fails if this process grows all the while. what:
// "build". The argument of `once` counts from 0.
Outcome find_leaks(const std::string& what, unsigned times, const std::function<void(unsigned)>& once);

}  // namespace clarity::check
