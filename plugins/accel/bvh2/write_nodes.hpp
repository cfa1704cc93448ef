// write_nodes.hpp -- a finished binary tree, from the builder's scattered places into the host's memory.
#pragma once
#include <vector>

#include "builder.hpp"

namespace bvh2 {

struct Written {
    const bvh2_node* nodes;
    rt_u32 count;
    std::vector<rt_u32> roots;  // of groups, ascending
};

// Allocates slot 0, writes all trees depth-first, each group's behind the last one's, and reports the roots.
Written write_nodes(const rt_host* host, const BinaryTree& tree, const rt_build_output* out);

}  // namespace bvh2
