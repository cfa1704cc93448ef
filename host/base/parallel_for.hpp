// parallel_for.hpp -- a loop on all cores.
#pragma once
#include <cstdint>
#include <functional>

namespace clarity {

// body(i) for i in [0, count), on all cores; returns when all are done. Nests. An exception of a body is rethrown here; of
// several, the one of the lowest i, however the threads ran (bodies beyond it may then have been left out).
void parallel_for(uint32_t count, const std::function<void(uint32_t)>& body);

}  // namespace clarity
