// refit.hpp -- the extension `refit` of cwbvh: new volumes for primitives that moved, in the same tree.
#pragma once
#include "rt_plugin.hpp"

namespace cwbvh {

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out);

}  // namespace cwbvh
