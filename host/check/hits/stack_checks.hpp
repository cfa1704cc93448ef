// stack_checks.hpp -- whether a traversal asks the host where it must: before its stack grows, and about each primitive.
#pragma once
#include "check/hits/bench.hpp"

namespace clarity::check {

// No stack is full, over the mixed scene, over meshes that are far deeper than their world, and over rows, which fill it.
Outcome stack_check(const BenchInput& input, Bench& mixed, Bench& regular, const Step& step);
// What asks RT_STACK_OK before each push finds next to nothing once that is always refused.
Outcome pushes_check(const BenchInput& input, const Step& step);
// Rays that meet the boxes of all primitives go on to the end.
Outcome crowd_check(const BenchInput& input, const Step& step);
// Every hit was tested by the host's function.
Outcome counts_check(const BenchInput& input, const Step& step);

}  // namespace clarity::check
