// build_checks.hpp -- whether a builder is sound: what it writes, and how it behaves.
#pragma once
#include <cstdint>
#include <vector>

#include "rt_plugin.h"
#include "tools/check/steps.hpp"

namespace clarity::check {

// The checks of one structure's builder, in the order in which they run. quick: fewer scenes and repetitions. seed: of random
// numbers (stand/seed.hpp). large: `many` is more than 2^20 triangles.
std::vector<Check> build_checks(const rt_plugin& plugin, bool quick, uint64_t seed = 0, bool large = false);

}  // namespace clarity::check
