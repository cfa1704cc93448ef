// plugin_copy.hpp -- copies a plugin's description into structs of this host's own size.
#pragma once
#include "base/problem.hpp"
#include "rt_plugin.h"

namespace clarity {

// Returns a copy of a loaded plugin's description: all its structs, and the arrays of its parameters, slots and extensions with
// elements of the host's size. Fields that the plugin does not have are zero. Texts and functions stay where they are. The copy
// lives as long as the process, as the library does, and there is one for each library. Returns nullptr, and why, if a struct
// or an element is too small. What is in the fields is not checked; see check_plugin(). The head of the description must have
// been checked (check_plugin_head).
const rt_plugin* copy_plugin(const rt_plugin& plugin, Problem& why);

}  // namespace clarity
