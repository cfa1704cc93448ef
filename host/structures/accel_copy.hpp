// accel_copy.hpp -- copies of a finished structure: for structures that move, and for kernels that are tried.
#pragma once
#include "structures/accel_build.hpp"

namespace clarity {

// Copies the structure. For each slot and for the leaves, memory(bytes of `from`) returns the bytes of the copy: its own copy
// of them, or the same bytes, borrowed.
template <class Memory>
AccelData copy_of(const AccelData& from, Memory&& memory) {
    AccelData copy;
    static_cast<AccelFacts&>(copy) = from;
    for (const AccelData::Slot& slot : from.slots) copy.slots.push_back({memory(slot.memory), slot.count});
    copy.leaves = memory(from.leaves);
    copy.leaf_count = from.leaf_count;
    copy.instances = from.instances;
    copy.scene = from.scene;
    static_assert(has_member_count<AccelData, 6>, "a new member has to be copied here");
    return copy;
}

}  // namespace clarity
