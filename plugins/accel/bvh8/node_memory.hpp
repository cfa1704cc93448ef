// node_memory.hpp -- converts a finished node to the memory layout that its traversal reads. bvh8 reads nodes as they were
// written. bvh4 permutes the rows of its nodes, and refers to a child by the address at which its rows begin (bvh4_types.h).
#pragma once
#include <algorithm>
#include <array>
#include <cstring>

#include "rt_plugin.h"
// needs the types of rt_types.h, so it must follow the headers above:
#include "bvh8_types.h"
#if BVH8_WIDTH == 4
#include "bvh4_types.h"
#endif

namespace bvh8 {

#if BVH8_WIDTH == 4

// Permutes the rows of node `at`. Calling it twice restores the node.
inline void turn_rows(bvh8_node& node, rt_u32 at) {
    std::array<std::array<rt_f32, 4>, 8> rows, turned;
    static_assert(sizeof rows == sizeof node, "");
    std::memcpy(rows.data(), &node, sizeof node);
    for (rt_u32 k = 0; k < rows.size(); ++k) turned[k ^ (at & 7u)] = rows[k];
    std::memcpy(&node, turned.data(), sizeof node);
}

inline void settle(bvh8_node nodes[], rt_u32 at) {
    for (rt_u32& child : nodes[at].child)
        if (!(child & BVH8_LEAF)) child = BVH4_NODE_REF(child);
    turn_rows(nodes[at], at);
}

// Returns node `at` as it was before settle().
inline bvh8_node settled_node(const bvh8_node nodes[], rt_u32 at) {
    bvh8_node node = nodes[at];
    turn_rows(node, at);
    for (rt_u32& child : node.child)
        if (!(child & BVH8_LEAF)) child = BVH4_INDEX(child);
    return node;
}

#else

inline void settle(bvh8_node[], rt_u32) {}
inline const bvh8_node& settled_node(const bvh8_node nodes[], rt_u32 at) {
    return nodes[at];
}

#endif

}  // namespace bvh8
