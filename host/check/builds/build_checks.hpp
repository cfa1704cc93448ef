// build_checks.hpp -- whether a builder is sound: what it writes, and how it behaves.
#pragma once
#include <vector>

#include "check/steps.hpp"
#include "rt_plugin.h"

namespace clarity::check {

// The checks of one structure's builder, in the order in which they run. quick: fewer scenes and repetitions.
std::vector<Check> build_checks(const rt_plugin& plugin, bool quick);

}  // namespace clarity::check
