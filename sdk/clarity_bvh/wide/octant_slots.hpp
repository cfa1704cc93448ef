// octant_slots.hpp -- writes wide nodes. The slot of a child tells in which octant of the node the child lies.
#pragma once
#include "clarity_bvh/wide/wide_node.hpp"

namespace clarity::bvh {

// Writes a whole node; a WideLayout::write. Slot i lies towards the corner of the node that has a high coordinate k where bit k
// of i is set. Let s have the signs of a ray's direction in bits 0, 1, 2, for x, y, z: then visiting slot i ^ s for i = 0..7
// mostly meets near children before far ones (Ylitie, Karras, Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through
// Compressed Wide BVHs"). The box of an empty slot has no extent and lies at (FLT_MAX, FLT_MAX, FLT_MAX).
void write_octant_node(WideNode<8>& node, const Slot children[], const uint32_t code[], uint32_t count);

}  // namespace clarity::bvh
