// plugin.hpp -- the functions behind the plugin's table.
#pragma once
#include "bvh2_rt.hpp"

namespace bvh2 {

int32_t build(const rt_host* host, const rt_build_input* input, const rt_build_output* out);
int32_t levels(const rt_host* host, const rt_built* built, rt_u32 group, rt_u32 level, const rt_volume_sink* sink);

}  // namespace bvh2
