// pack.hpp -- writes trees in the layout of cwbvh: its own builds, and any binary topology.
#pragma once
#include "clarity_bvh/topology.hpp"
#include "rt_plugin.hpp"

namespace cwbvh {

// Packs a tree and writes all of the plugin's output: slot, leaf order, roots, defines, statistics. refs: the refs of the
// tree's primitives in leaf order. input.params are the plugin's parameters; input.prims are not read. Leaves have at most
// CWBVH_LEAF_MAX primitives.
void pack(const rt_host* host, const rt_build_input& input, clarity::bvh::Topology& topology, const rt_u32* refs,
          const rt_build_output* out);
// Builds a tree by the plugin's parameters, and packs it.
int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out);

}  // namespace cwbvh
