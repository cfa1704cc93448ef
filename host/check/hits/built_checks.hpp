// built_checks.hpp -- what is built in other ways than usual is traced, too: with other parameters, packed from another
// builder's tree, refitted, empty, and large.
#pragma once
#include "check/hits/bench.hpp"

namespace clarity::check {

// The checks, in the order in which they run.
std::vector<Check> built_checks(const BenchInput& input);

}  // namespace clarity::check
