// wide_check.hpp -- checks every node of a tree of eight children a node, and of a compressed one.
#pragma once
#include <string>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh8_types.h"
#include "cwbvh_types.h"

namespace accel_test {

// Returns the faults that were found; empty if there are none. It checks that every primitive of each group is in exactly one
// leaf of its tree; that boxes are exactly the bounds of their contents; that leaves hold at most max_leaf primitives; that
// nodes are in depth-first order, and each belongs to one tree; that no ray can hit an empty slot; and that the reported
// statistics and stack size match the trees.
std::string check_bvh8(const Input& input, const Built& built, uint32_t max_leaf = 7, double traversal_cost = 3,
                       double intersection_cost = 0.4);

// Checks every node of a compressed tree.

// Returns the faults that were found; empty if there are none. It checks that every primitive of each group is in exactly one
// leaf of its tree; that each slot's box contains its contents with the margin that kernels rely on, and no plane lies more
// than a cell beyond that margin; that siblings (nodes and primitives) are stored together in the order of their slots; that
// each node belongs to one tree; that no ray can hit an empty slot; and that the reported statistics and stack sizes match the
// trees.
std::string check_cwbvh(const Input& input, const Built& built, uint32_t max_leaf = 4);

}  // namespace accel_test
