// host_build.hpp -- the tree of ploc_build.cl, built on the host: for devices and commands that do not build there.
#pragma once
#include "rt_plugin.h"

namespace ploc {

// rt_accel::topology. Inner nodes of a group come first, then the leaves in order along the curve.
int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out);

}  // namespace ploc
