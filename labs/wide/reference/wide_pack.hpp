// wide_pack.hpp -- our solution of the lab: Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
// Compressed Wide BVHs". A frame is the least corner of the node, and a step for each axis, which is a power of two.
#pragma once
#include <cmath>

#include "lab_tree.hpp"
#include "wide_types.h"

inline void wide_pack(const lab::Box& all, const lab::Box* boxes, int count, wide_node& node) {
    for (int axis = 0; axis < 3; ++axis) {
        const float origin = all.lo[axis];
        float step = std::ldexp(1.0f, std::max(std::ilogb(std::max(all.hi[axis] - origin, 1e-30f) / 255), -120));
        while (origin + step * 255 < all.hi[axis]) step *= 2;
        node.frame[axis] = origin, node.frame[3 + axis] = step;
        for (int i = 0; i < count; ++i) {
            // Outwards: down, and up. The loops mend what the division has rounded.
            float lo = std::floor((boxes[i].lo[axis] - origin) / step), hi = std::ceil((boxes[i].hi[axis] - origin) / step);
            lo = std::min(std::max(lo, 0.0f), 255.0f), hi = std::min(std::max(hi, 0.0f), 255.0f);
            while (lo > 0 && origin + step * lo > boxes[i].lo[axis]) --lo;
            while (hi < 255 && origin + step * hi < boxes[i].hi[axis]) ++hi;
            node.lo[i][axis] = static_cast<unsigned char>(lo), node.hi[i][axis] = static_cast<unsigned char>(hi);
        }
    }
}
