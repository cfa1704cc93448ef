// statistics.hpp -- measures the quality of a finished tree from its nodes.
#pragma once
#include <vector>

#include "clarity_bvh/rules.hpp"
#include "rt_plugin.h"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh2_types.h"

namespace bvh2 {

struct Statistics {
    uint64_t leaves = 0;
    // Expected cost of a ray that hits the root's box. Each node and primitive counts with its probability of a visit (its
    // surface over the root's) times its cost by the rules. It is the mean over all groups, weighted by their numbers of
    // primitives. An instance costs as much as a primitive.
    double sah_cost = 0;
};

// Measures the trees, on all cores. The nodes of group g begin at roots[g] and end where those of the next group begin, or at
// node_count.
Statistics measure(const rt_host* host, const clarity::bvh::Rules& rules, const bvh2_node* nodes, rt_u32 node_count,
                   const std::vector<rt_u32>& roots, const rt_group* groups);

}  // namespace bvh2
