// node_slots.hpp -- chooses the slot of each child in a finished node, and writes the node.
#pragma once
#include "collapse.hpp"

namespace bvh8 {

// Writes a whole node. children[i] gets the child code code[i], and the slot that best suits its position in the node
// (bvh8_types.h).
void write_node(bvh8_node& node, const Slot children[], const rt_u32 code[], uint32_t count);

}  // namespace bvh8
