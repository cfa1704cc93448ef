// bvh2_check.hpp -- checks every node of a bvh2 tree.
#pragma once
#include <string>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"

namespace accel_test {

// Returns the faults that were found; empty if there are none. It checks that every primitive of each group is in exactly one
// leaf of its tree; that boxes are exactly the bounds of their contents; that leaves hold at most max_leaf primitives; that
// nodes are in depth-first order, with the larger child first unless larger_first is false; that each node belongs to one tree;
// and that the reported depth, counts and stack size match the trees.
std::string check_bvh2(const Input& input, const Built& built, uint32_t max_leaf = 4, bool larger_first = true);

// Computes the cost that the builder should report: see pack.cpp of bvh2.
double sah_cost(const Input& input, const Built& built, double traversal_cost = 1, double intersection_cost = 1);

}  // namespace accel_test
