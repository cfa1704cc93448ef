// node_slots.hpp -- which child stands where in a node.
#pragma once
#include "collapse.hpp"

namespace bvh8 {

// slot_of[i]: the slot of children[i], so that slots in the order i ^ signs come near before far (see bvh8_types.h).
void assign_slots(const Slot children[], uint32_t count, uint32_t slot_of[]);

// A node without children.
void clear_node(bvh8_node& node);
void set_slot(bvh8_node& node, uint32_t slot, const float box[6], rt_u32 child);

}  // namespace bvh8
