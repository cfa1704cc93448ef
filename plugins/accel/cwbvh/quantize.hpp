// quantize.hpp -- the boxes of a node as bytes, and back.
#pragma once
#include "rt_plugin.h"
// after rt_types.h, whose types they use:
#include "bvh8_types.h"
#include "cwbvh_types.h"

namespace cwbvh {

// Origin, cells and planes of a node of bvh8's: each box, widened by CWBVH_MARGIN cells, lies in its quantised one, and cells
// are as small as powers of two can be. An axis so long that no cell fits has an origin that is no number: kernels then meet
// all of it. Slots that are nodes and all that names them is left to others.
void quantize(const bvh8_node& from, cwbvh_node& to);

// The box of a slot: in double precision, by far finer than the margin.
void box_of(const cwbvh_node& node, uint32_t slot, double lo[3], double hi[3]);

}  // namespace cwbvh
