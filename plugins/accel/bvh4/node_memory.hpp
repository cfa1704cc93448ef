// node_memory.hpp -- converts a finished node to the memory layout that the traversal reads: its rows are permuted, and it
// refers to a child by the address at which its rows begin (bvh4_types.h).
#pragma once
#include <array>
#include <cstring>

#include "clarity_bvh/wide/wide_node.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "bvh4_types.h"

namespace bvh4 {

// Permutes the rows of node `at`. Calling it twice restores the node.
inline void turn_rows(clarity::bvh::WideNode<4>& node, uint32_t at) {
    std::array<std::array<float, 4>, 8> rows, turned;
    static_assert(sizeof rows == sizeof node, "");
    std::memcpy(rows.data(), &node, sizeof node);
    for (uint32_t k = 0; k < rows.size(); ++k) turned[k ^ (at & 7u)] = rows[k];
    std::memcpy(&node, turned.data(), sizeof node);
}

// A WideLayout::settle.
inline void settle(clarity::bvh::WideNode<4> nodes[], uint32_t at) {
    for (uint32_t& child : nodes[at].child)
        if (!clarity::bvh::is_leaf(child)) child = BVH4_NODE_REF(child);
    turn_rows(nodes[at], at);
}

// Returns node `at` as it was before settle().
inline clarity::bvh::WideNode<4> settled_node(const clarity::bvh::WideNode<4> nodes[], uint32_t at) {
    clarity::bvh::WideNode<4> node = nodes[at];
    turn_rows(node, at);
    for (uint32_t& child : node.child)
        if (!clarity::bvh::is_leaf(child)) child = BVH4_INDEX(child);
    return node;
}

}  // namespace bvh4
