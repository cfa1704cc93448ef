// plane_checks.hpp -- whether rays that run exactly along planes of boxes and cells hit what they should.
#pragma once
#include "check/hits/bench.hpp"

namespace clarity::check {

// The check `hits.planes`.
Check planes_check(const BenchInput& input);

}  // namespace clarity::check
