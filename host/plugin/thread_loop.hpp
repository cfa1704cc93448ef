// thread_loop.hpp -- parallel_for where TBB is missing: std::thread only.
#pragma once
#include <cstdint>
#include <functional>

namespace clarity {

// body(i) once for each i in [0, count). The body must not throw. Loops may nest: all of them together take no more threads
// than the machine has cores, an inner loop that finds none free runs on its caller's.
void thread_loop(uint32_t count, const std::function<void(uint32_t)>& body);

}  // namespace clarity
