// parallel_for.hpp -- a parallel loop.
#pragma once
#include <cstdint>
#include <functional>

namespace clarity {

// Calls body(i) for every i in [0, count) on all cores and returns when all calls are done. Calls may be nested. If bodies
// throw, the exception of the lowest i is rethrown here, independent of the order of the threads; bodies of higher indices may
// then be skipped.
void parallel_for(uint32_t count, const std::function<void(uint32_t)>& body);

// How many threads such a loop takes: as many as this process may use processors.
unsigned loop_threads();

}  // namespace clarity
