// bvh8_check.hpp -- checks every node of a bvh8 tree.
#pragma once
#include <string>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh8_types.h"

namespace accel_test {

// Returns the faults that were found; empty if there are none. It checks that every primitive of each group is in exactly one
// leaf of its tree; that boxes are exactly the bounds of their contents; that leaves hold at most max_leaf primitives; that
// nodes are in depth-first order, and each belongs to one tree; that no ray can hit an empty slot; and that the reported
// statistics and stack size match the trees.
std::string check_bvh8(const Input& input, const Built& built, uint32_t max_leaf = 7, double traversal_cost = 3,
                       double intersection_cost = 0.4);

}  // namespace accel_test
