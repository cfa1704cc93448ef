// compress.hpp -- converts a finished 8-wide tree to compressed nodes.
#pragma once
#include <vector>

#include "quantize.hpp"

namespace cwbvh {

// An 8-wide tree: its nodes in depth-first order, its leaf order, and the roots of its groups.
struct WideNodes {
    const WideNode* nodes;
    rt_u32 node_count;
    const rt_u32* refs;
    uint64_t ref_count;
    const std::vector<rt_u32>* roots;
};

// Writes slot 0 and the leaf order, and reports the roots, on all cores. The output is in the order of the parents: the
// children of a node are stored together, in the order of their parents, and so are its primitives. Both positions are sums
// over all earlier nodes. So each part of the tree can be written independently of the others.
void compress(const rt_host* host, const WideNodes& wide, const rt_build_output* out);

}  // namespace cwbvh
