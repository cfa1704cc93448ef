// run_builder.hpp -- calls the builder of either kind of structure in one way: one with slots, or one that builds a topology.
#pragma once
#include "rt_plugin.h"

namespace clarity {

// The slots that a plugin's builder fills: the structure's own; of a topology one, its nodes.
const rt_accel& built_slots(const rt_plugin& plugin);

// Calls build(). Of a topology it calls topology(): the nodes are slot 0 of `out`, the refs its leaves. A root may be RT_NONE
// then. On the calling thread; returns the plugin's status.
int32_t run_builder(const rt_plugin& plugin, const rt_host* host, const rt_build_input* input, const rt_build_output* out);

}  // namespace clarity
