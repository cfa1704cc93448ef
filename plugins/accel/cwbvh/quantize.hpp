// quantize.hpp -- converts the boxes of a node to bytes and back.
#pragma once
#include "clarity_bvh/wide/wide_node.hpp"
// needs the types of rt_shared.h, so it must follow the headers above:
#include "cwbvh_types.h"

namespace cwbvh {

using WideNode = clarity::bvh::WideNode<8>;

// The bounds of the slots of a node: for x, y, z those of slots 0..3 and of 4..7. Empty slots have any numbers.
struct Bounds8 {
    clarity::bvh::Vec4 lo[3][2], hi[3][2];
};

// Sets the origin, cells and planes of a compressed node. Each quantised box contains the box of `from`, widened by
// CWBVH_MARGIN cells. The cell size is the smallest possible power of two. If an axis is so long that no cell size fits, its
// origin becomes NaN, and kernels then treat it as unbounded. The caller sets the slots that are nodes, and all indices.
// used: a bit for each slot that has a child.
void quantize(const Bounds8& from, uint32_t used, cwbvh_node& to);
void quantize(const WideNode& from, cwbvh_node& to);

// Returns the quantised box of a slot, in double precision: its rounding error is far below the margin.
void box_of(const cwbvh_node& node, uint32_t slot, double lo[3], double hi[3]);

}  // namespace cwbvh
