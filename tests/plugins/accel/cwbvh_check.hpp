// cwbvh_check.hpp -- looks at every node of a compressed tree and says what is wrong with it.
#pragma once
#include <string>

#include "harness.hpp"
// after rt_types.h, whose types it uses:
#include "cwbvh_types.h"

namespace accel_test {

// Every primitive of each group is in exactly one leaf of its tree; each slot's box holds what is below it with the margin that
// kernels count on, and no plane lies more than a cell and that margin outside; siblings stand in a row in the order of their
// slots, nodes as well as primitives; nodes belong to one tree; empty slots are out of reach; figures and stacks are those of
// the trees. Empty: all is well.
std::string check_cwbvh(const Input& input, const Built& built, uint32_t max_leaf = 4);

}  // namespace accel_test
