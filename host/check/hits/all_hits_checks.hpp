// all_hits_checks.hpp -- whether a structure finds all hits along a ray, and counts as many.
#pragma once
#include "check/hits/bench.hpp"

namespace clarity::check {

// The check `hits.all`.
Check all_hits_check(const BenchInput& input);

}  // namespace clarity::check
