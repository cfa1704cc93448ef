// wide_levels.hpp -- the boxes of one level of a group's tree, for drawing.
#pragma once
#include "rt_plugin.h"

namespace bvh8 {

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink);

}  // namespace bvh8
