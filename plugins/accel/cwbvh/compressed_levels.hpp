// compressed_levels.hpp -- the boxes of one level of a group's tree, for drawing: as rays meet them, so wider than what they
// hold.
#pragma once
#include "rt_plugin.h"

namespace cwbvh {

int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink);

}  // namespace cwbvh
