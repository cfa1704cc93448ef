// reserved_names.hpp -- names of the host that a plugin's kernels must not define.
#pragma once
#include "base/problem.hpp"
#include "rt_plugin.h"

namespace clarity::check {

// What is wrong: "my_tree.cl:3 defines RT_LANES, ..."; empty: nothing. A compiler's message about it would be a riddle.
Problem reserved_name_fault(const rt_plugin& tracer);

}  // namespace clarity::check
