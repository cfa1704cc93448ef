// statistics.hpp -- what a finished tree is worth, measured on the nodes themselves.
#pragma once
#include <vector>

#include "range.hpp"
#include "rt_plugin.h"
// after rt_types.h, whose types it uses:
#include "bvh2_types.h"

namespace bvh2 {

struct Statistics {
    uint64_t leaves = 0;
    // Expected cost of a ray that meets the root's box: nodes and primitives, weighted by how likely each is met (its surface
    // over the root's) and by the rules' costs; the mean over all groups, weighted by their primitives. Instances cost one
    // primitive.
    double sah_cost = 0;
};

// roots[g] begins the nodes of group g, which end where those of the next begin, and the last ones at node_count.
Statistics measure(const rt_host* host, const Rules& rules, const bvh2_node* nodes, rt_u32 node_count,
                   const std::vector<rt_u32>& roots, const rt_group* groups);

}  // namespace bvh2
