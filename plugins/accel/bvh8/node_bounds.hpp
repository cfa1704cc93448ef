// node_bounds.hpp -- reads the boxes of a finished node.
#pragma once
#include <algorithm>

#include "rt_plugin.h"
// needs the types of rt_types.h, so it must follow the headers above:
#include "bvh8_types.h"

namespace bvh8 {

// Calls do_one(box, child) for every child of the node. Empty slots are skipped.
template <class Body>
void each_child(const bvh8_node& node, Body&& do_one) {
    for (int slot = 0; slot < BVH8_WIDTH; ++slot) {
        if (node.child[slot] == BVH8_EMPTY) continue;
        float box[6];
        for (int k = 0; k < 6; ++k) box[k] = node.plane[k][slot];
        do_one(box, node.child[slot]);
    }
}

// Computes the box around all children. Returns false if there are none.
inline bool bounds(const bvh8_node& node, float box[6]) {
    bool any = false;
    each_child(node, [&](const float child[6], rt_u32) {
        for (int a = 0; a < 3; ++a) {
            box[a] = any ? std::min(box[a], child[a]) : child[a];
            box[3 + a] = any ? std::max(box[3 + a], child[3 + a]) : child[3 + a];
        }
        any = true;
    });
    return any;
}

}  // namespace bvh8
