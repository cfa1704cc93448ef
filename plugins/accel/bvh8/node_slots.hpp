// node_slots.hpp -- one finished node: which child stands in which slot.
#pragma once
#include "collapse.hpp"

namespace bvh8 {

// Writes a whole node. children[i] goes by code[i], and to the slot that suits its place in the node best (bvh8_types.h).
void write_node(bvh8_node& node, const Slot children[], const rt_u32 code[], uint32_t count);

}  // namespace bvh8
