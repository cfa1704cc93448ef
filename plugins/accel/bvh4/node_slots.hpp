// node_slots.hpp -- chooses the slot of each child in a node, and writes the node. With four slots, the order that packets use
// (by direction signs) covers two axes.
#pragma once
#include "clarity_bvh/wide/wide_node.hpp"

namespace bvh4 {

using clarity::bvh::Slot;
using WideNode = clarity::bvh::WideNode<4>;

// Writes a whole node; a WideLayout::write. Bits 0 and 1 of a child's slot tell on which side of the node it lies in x and y.
// The box of an empty slot reaches from +inf to -inf.
void write_node(WideNode& node, const Slot children[], const uint32_t code[], uint32_t count);

}  // namespace bvh4
