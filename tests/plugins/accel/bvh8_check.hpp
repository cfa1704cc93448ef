// bvh8_check.hpp -- looks at every node of a bvh8 tree and says what is wrong with it.
#pragma once
#include <string>

#include "harness.hpp"
// after rt_types.h, whose types it uses:
#include "bvh8_types.h"

namespace accel_test {

// Every primitive of each group is in exactly one leaf of its tree; boxes are exactly the bounds of what is below; leaves hold
// no more than max_leaf; nodes stand in depth-first order and belong to one tree; slots without child are out of reach; the
// reported figures and the stack are those of the trees. Empty: all is well.
std::string check_bvh8(const Input& input, const Built& built, uint32_t max_leaf = 7, double traversal_cost = 3,
                       double intersection_cost = 0.4);

}  // namespace accel_test
