// host_build.hpp -- the tree of lbvh_build.cl, built on the host: for devices and commands that do not build there.
#pragma once
#include "rt_plugin.h"

namespace lbvh {

// rt_accel::topology. Node i of a group is node i of Karras's numbering; the leaves follow, in order along the curve.
int32_t topology(const rt_host* host, const rt_build_input* input, const rt_topology_output* out);

}  // namespace lbvh
