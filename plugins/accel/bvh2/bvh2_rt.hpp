// bvh2_rt.hpp -- the plugin ABI and the structs shared with the traversal, in the order they need.
#pragma once
#include "rt_plugin.h"
// after rt_types.h, whose scalar types it uses:
#include "bvh2_types.h"
