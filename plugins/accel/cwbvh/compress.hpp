// compress.hpp -- a finished tree of bvh8's as one of compressed nodes.
#pragma once
#include <vector>

#include "quantize.hpp"

namespace cwbvh {

// bvh8_nodes in depth-first order, the leaf order that they name, the roots of the groups.
struct WideNodes {
    const bvh8_node* nodes;
    rt_u32 node_count;
    const rt_u32* refs;
    uint64_t ref_count;
    const std::vector<rt_u32>* roots;
};

// Writes slot 0 and the leaf order, and reports the roots, on all cores. Children stand in the order of their parents, siblings
// together, and so do primitives: both places are sums over the nodes before, so that every part of the tree is written where
// it belongs without the others.
void compress(const rt_host* host, const WideNodes& wide, const rt_build_output* out);

}  // namespace cwbvh
