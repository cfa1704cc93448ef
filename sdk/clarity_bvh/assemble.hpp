// assemble.hpp -- makes a topology of binary trees that another builder made.
#pragma once
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// Makes the topology of the trees of all groups. Nodes may stand in any order, and nodes that no root reaches are ignored.
// Leaves may name a primitive several times. Only the boxes of leaves are read: those of inner nodes are made from them, so
// that each holds what is below it. Bounds that are NaN or infinite become the farthest finite ones, and bounds in the wrong
// order are swapped. A leaf of more than max_leaf (1..kLeafMax) refs becomes a tree of smaller ones with the same box: that is
// sound, and slower than splitting by place. The child with the larger surface comes first. The refs are written to `refs` in
// the order of the leaves, so that the refs below each node stand together.
//
// Throws std::invalid_argument, with the reason in words for the tree's author, if the trees are none: an index out of range, a
// node with two parents, a leaf without refs or with refs out of range, a leaf with more than RT_TOPOLOGY_DEPTH nodes on the
// way to it, too many refs. `trees` is read during the call only.
Topology assemble(const rt_host* host, const rt_topology& trees, uint32_t max_leaf, const RefMemory& refs);

// The description of trees in these arrays, which it names and which must outlive it. roots: one for each group.
inline rt_topology trees_of(const std::vector<rt_topology_node>& nodes, const std::vector<rt_u32>& roots,
                            const std::vector<rt_u32>& refs) {
    return {sizeof(rt_topology), static_cast<rt_u32>(roots.size()), nodes.data(), nodes.size(), refs.data(), refs.size(),
            roots.data()};
}

// rt_accel::pack for a layout that packs topologies: rt::guarded<pack_trees<pack, MY_LEAF_MAX>>. `pack` writes all of the
// plugin's output; refs are those of the tree's primitives in leaf order.
using PackTopology = void (*)(const rt_host* host, const rt_build_input& input, Topology& topology, const rt_u32* refs,
                              const rt_build_output* out);
template <PackTopology pack, uint32_t max_leaf>
int32_t pack_trees(const rt_host* host, const rt_build_input* input, const rt_topology* trees, const rt_build_output* out) {
    Scratch<rt_u32> refs(trees->ref_count);
    Topology topology = assemble(host, *trees, max_leaf, [&](uint64_t) { return refs.data(); });
    pack(host, *input, topology, refs.data(), out);
    return RT_OK;
}

}  // namespace clarity::bvh
