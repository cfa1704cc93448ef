// bvh2_check.hpp -- looks at every node of a bvh2 tree and says what is wrong with it.
#pragma once
#include <string>

#include "harness.hpp"
// after rt_types.h, whose types it uses:
#include "bvh2_types.h"

namespace accel_test {

// Every primitive of each group is in exactly one leaf of its tree; boxes are exactly the bounds of what is below; leaves hold
// no more than max_leaf; nodes stand in depth-first order, the larger child first unless told otherwise, and
// belong to one tree; the reported depth, counts and stack are
// those of the trees. Empty: all is well.
std::string check_bvh2(const Input& input, const Built& built, uint32_t max_leaf = 4, bool larger_first = true);

// The cost that the builder reports, by its definition: see statistics.hpp of bvh2.
double sah_cost(const Input& input, const Built& built, double traversal_cost = 1, double intersection_cost = 1);

}  // namespace accel_test
