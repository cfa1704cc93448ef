// wide_pack.hpp -- puts the boxes of a node's children into bytes. You hand in this file and wide_unpack.h.
#pragma once
#include "lab_tree.hpp"
#include "wide_types.h"

// all: around the boxes of all children. boxes: that of each, `count` of them. Fills in node.frame, node.lo and node.hi: what
// wide_unpack.h makes of them must enclose each box.
inline void wide_pack(const lab::Box& all, const lab::Box* boxes, int count, wide_node& node) {
    (void)boxes, (void)count;
    std::copy(all.lo, all.lo + 3, node.frame), std::copy(all.hi, all.hi + 3, node.frame + 3);
}
