// compressed_levels.hpp -- lists the boxes of one level of a group's tree, for drawing. These are the quantised boxes that rays
// are tested against, so they are wider than their contents.
#pragma once
#include "rt_plugin.h"

namespace cwbvh {

// Passes the boxes of `level` to the sink: 0 is the root's box, RT_LEVEL_BOTTOM is all leaves. Throws if the group does not
// exist.
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink);

}  // namespace cwbvh
