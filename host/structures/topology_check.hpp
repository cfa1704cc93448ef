// topology_check.hpp -- is a topology, a plain binary tree that another plugin packs, sound?
#pragma once
#include <string>

#include "base/problem.hpp"
#include "rt_plugin.h"
#include "structures/build_scene.hpp"
#include "structures/builder_output.hpp"

namespace clarity {

// What the builder of a topology wrote (builder_output.hpp), as its layout gets it. It must outlive the return value.
template <class Bytes>
rt_topology topology_of(const BuilderResultIn<Bytes>& result) {
    rt_topology topology{};
    topology.struct_bytes = sizeof topology;
    topology.group_count = static_cast<rt_u32>(result.roots.size());
    topology.nodes = static_cast<const rt_topology_node*>(result.slots[0].memory.data());
    topology.node_count = result.slots[0].count;
    topology.refs = static_cast<const rt_u32*>(result.refs.data());
    topology.ref_count = result.leaf_count;
    topology.roots = result.roots.data();
    return topology;
}

// Returns how the builder broke its contract, in its terms: "gave node 4 of group 0 two parents"; empty: each root has a tree
// of its own whose leaves name all refs of the group. Boxes are not checked.
Problem topology_fault(const rt_topology& topology, const BuildScene& scene);

}  // namespace clarity
