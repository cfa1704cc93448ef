// pack.hpp -- turns the binary tree of another plugin into nodes of bvh2.
#pragma once
#include <vector>

#include "rt_plugin.h"
// needs the types of rt_shared.h, so it must follow the header above:
#include "bvh2_types.h"

namespace bvh2 {

// The nodes of all groups in depth-first order, one group after the other. Positions in leaf order are those of the topology's
// refs.
struct Packed {
    std::vector<bvh2_node> nodes;
    std::vector<rt_u32> roots;
    uint32_t depth = 1;  // number of nodes on the path from a root to the deepest leaf
};

// Leaves of more than BVH2_LEAF_MAX refs become trees of leaves, which all have the box of the leaf. Throws rt::Cancelled.
Packed pack_topology(const rt_host* host, const rt_topology& topology);

}  // namespace bvh2
