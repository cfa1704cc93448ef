// write_nodes.hpp -- copies a finished binary tree from the builder's arrays into the host's memory.
#pragma once
#include <vector>

#include "builder.hpp"

namespace bvh2 {

struct Written {
    const bvh2_node* nodes;
    rt_u32 count;
    std::vector<rt_u32> roots;  // of groups, ascending
};

// Allocates slot 0 of `out`, writes the trees of all groups there in depth-first order, one group after the other, and reports
// the roots. The host owns the nodes.
Written write_nodes(const rt_host* host, const BinaryTree& tree, const rt_build_output* out);

}  // namespace bvh2
