// cwbvh_check.hpp -- checks every node of a compressed tree.
#pragma once
#include <string>

#include "harness.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "cwbvh_types.h"

namespace accel_test {

// Returns the faults that were found; empty if there are none. It checks that every primitive of each group is in exactly one
// leaf of its tree; that each slot's box contains its contents with the margin that kernels rely on, and no plane lies more
// than a cell beyond that margin; that siblings (nodes and primitives) are stored together in the order of their slots; that
// each node belongs to one tree; that no ray can hit an empty slot; and that the reported statistics and stack sizes match the
// trees.
std::string check_cwbvh(const Input& input, const Built& built, uint32_t max_leaf = 4);

}  // namespace accel_test
