// reinsert.hpp -- makes a finished binary tree cheaper: subtrees are taken out and put back where the tree grows least
// (Meister, Bittner 2018, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization").
//
// The paper's search for the best place is kept; its locks are not. Places are searched on all cores for some thousand
// subtrees at once. Then one thread makes the moves, the best first, and first weighs each again in the tree as it is by then.
// So the cost never grows, and the result does not depend on the number of threads.
#pragma once
#include "clarity_bvh/rules.hpp"
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// Moves subtrees so that the sum of the inner nodes' surfaces shrinks, and returns that tree. `refs_in`: the refs of `tree`, in
// leaf order. The first pass looks at the largest 64th of all subtrees, which brings the most, and each of the next at four
// times as many. The passes end after rules.reinsert, or once one over all subtrees gains almost nothing. Then leaves are
// joined where the rules find that cheaper, up to rules.max_leaf. No way to a leaf becomes longer than the longest was by more
// than a few nodes, or than kMaxDepth. Reports progress from `begin` to `end`. Throws rt::Cancelled, or std::bad_alloc.
Topology reinsert(const rt_host* host, Topology tree, const Rules& rules, const uint32_t* refs_in, const RefMemory& refs,
                  float begin, float end);

// An upper bound of the memory of a call, `tree` included, in bytes.
uint64_t reinsert_bytes(uint64_t ref_count);

}  // namespace clarity::bvh
