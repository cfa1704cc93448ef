// parameter_tries.hpp -- values of a plugin's parameters that checks try.
#pragma once
#include <string>
#include <vector>

#include "plugin/parameters.hpp"

namespace clarity::check {

// Each parameter at its least and at its greatest value, all at their least, all at their greatest, and twice all somewhere in
// between. Empty if there are no parameters.
std::vector<ParameterValues> parameter_tries(const rt_plugin& plugin, uint64_t seed);

// "bvh2,max_leaf=1": as --accel takes it.
std::string choice_text(const rt_plugin& plugin, const ParameterValues& params);

}  // namespace clarity::check
