// run_builder.hpp -- calls the builder of any kind of structure in one way: one with slots, one that builds a topology, or one
// that packs the topology of another.
#pragma once
#include "rt_plugin.h"

namespace clarity {

// The slots that a plugin's builder fills: the structure's own; of a topology one, its nodes.
const rt_accel& built_slots(const rt_plugin& plugin);

// Calls build(); with a tree, pack(). Of a topology it calls topology(): the nodes are slot 0 of `out`, the refs its leaves. A
// root may be RT_NONE then. tree: of another builder, for the same input; may be nullptr. On the calling thread; returns the
// plugin's status.
int32_t run_builder(const rt_plugin& plugin, const rt_host* host, const rt_build_input* input, const rt_topology* tree,
                    const rt_build_output* out);

}  // namespace clarity
