// plan.hpp -- the steps of a build on the device: ploc_build.cl has the kernels.
#pragma once
#include "rt_device.h"

namespace ploc {

// rt_device_build::topology.
int32_t plan(const rt_host* host, const rt_device_plan* plan, const rt_device_input* input, rt_device_topology* result);

}  // namespace ploc
