// morton.hpp -- the fast builder: primitives are sorted along a space-filling curve, and nodes are parted where the highest bit
// of their places on it changes (Lauterbach, Garland, Sengupta, Luebke, Manocha 2009, "Fast BVH Construction on GPUs").
#pragma once
#include "kernels.hpp"

namespace bvh2 {

// A primitive's place on the curve (36 bits, 12 an axis, x highest) above its position (28 bits): sorting keys sorts both.
using MortonKey = uint64_t;
constexpr unsigned kPositionBits = 28;

// For records [range.begin, range.end) of buffer 0: keys[begin..end).
void make_keys(const Workspace& workspace, const Range& group, uint32_t begin, uint32_t end, MortonKey* keys);

// Sorts by place, equals as they came. What comes out is in `keys` again.
void sort_keys(const rt_host* host, MortonKey* keys, MortonKey* other, uint64_t count);

// Copies records [begin, end) in the order of their keys from buffer 0 to buffer 1.
void gather(const Workspace& workspace, const MortonKey* keys, uint32_t begin, uint32_t end);

// Where a sorted range of at least two is parted: the first position of the right part.
uint32_t morton_middle(const MortonKey* keys, uint32_t begin, uint32_t end);

// The tree of a sorted range in buffer 1, whose box it sets.
Subtree build_sorted(const Workspace& workspace, const MortonKey* keys, Range& range);

}  // namespace bvh2
