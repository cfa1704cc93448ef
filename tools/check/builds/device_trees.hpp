// device_trees.hpp -- binary trees as rt_device.h has them: whether a builder's is sound, and some for layouts to pack.
#pragma once
#include <vector>

#include "base/problem.hpp"
#include "rt_device.h"

namespace clarity::check {

// A tree in host memory.
struct DeviceTree {
    std::vector<rt_topology_node> nodes;
    std::vector<rt_u32> counts, order;
    rt_u32 root = 0;   // means nothing without nodes
    rt_u32 depth = 0;  // inner nodes above a leaf, at most
};

// Of each place in `order`, halves of the places, the root in the middle of the nodes.
DeviceTree halved_tree(const std::vector<rt_prim>& prims);
// Each node has one primitive and the rest: as deep as there are primitives.
DeviceTree chain_tree(const std::vector<rt_prim>& prims);

// What is wrong with the tree that a builder made over `prims`, in its terms: "gave node 4 two parents".
// leaves: receives the primitives' numbers in the order of the leaves.
Problem tree_fault(const DeviceTree& tree, const std::vector<rt_prim>& prims, std::vector<rt_u32>& leaves);

// Whether these are the numbers 0 .. count - 1, each once. Returns what is wrong: "names primitive 7 twice".
Problem order_fault(const std::vector<rt_u32>& order);

}  // namespace clarity::check
