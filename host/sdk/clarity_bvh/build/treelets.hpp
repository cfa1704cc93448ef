// treelets.hpp -- improves a finished topology (Karras, Aila 2013, "Fast Parallel Construction of High-Quality Bounding Volume
// Hierarchies"). From the bottom up, each node and the largest nodes below it make a treelet of up to seven subtrees, and the
// cheapest of all trees over these seven takes the place of the old one.
#pragma once
#include "clarity_bvh/topology.hpp"

namespace clarity::bvh {

// The cost of a node to a ray, in the unit of the cost of a primitive, and the number of passes over the tree.
struct TreeletRules {
    float traversal_cost = 1;
    uint32_t passes = 2;
};

// Returns a topology with the same leaves. Its cost by the surface area heuristic is at most that of `from`. old_refs: the refs
// of `from` in leaf order. The leaf order changes: the function writes the new one to `refs`. No leaf gets deeper than
// kMaxDepth unless one was before. Uses all cores; the result does not depend on their number. Throws std::bad_alloc, or
// rt::Cancelled if the user cancels.
Topology optimize_treelets(const rt_host* host, const Topology& from, const uint32_t* old_refs, const TreeletRules& rules,
                           const RefMemory& refs);

}  // namespace clarity::bvh
