// moved_group.hpp -- what a move did to one tree of a structure.
#pragma once
#include <cstdint>

#include "rt_plugin.h"

namespace clarity {

struct MovedGroup {
    rt_u32 group = 0;         // 0: the world; the others are one mesh each
    uint64_t primitives = 0;  // of its tree
    // Expected cost (SAH) of a ray by that after the tree's build; of devices: as far as they have told it. 1: as good as then.
    double cost_ratio = 1;
};

}  // namespace clarity
