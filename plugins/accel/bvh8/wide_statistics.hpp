// wide_statistics.hpp -- what a finished tree is worth, measured on the nodes themselves.
#pragma once
#include "wide_tree.hpp"

namespace bvh8 {

struct Statistics {
    uint64_t leaves = 0, children = 0;  // of all nodes, leaves included
    // Expected cost of a ray that meets the root's box, as bvh2 reports it: nodes and primitives, weighted by how likely each
    // is met (its surface over the root's) and by the costs; the mean over all groups, weighted by their primitives.
    double sah_cost = 0;
};

Statistics measure(const rt_host* host, const WideTree& tree, const Costs& costs, const rt_group* groups);

}  // namespace bvh8
