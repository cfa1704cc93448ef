// device_pack.hpp -- plans how a binary tree on the device becomes nodes of four children: bvh4_build.cl has the kernels.
#pragma once
#include "rt_device.h"

namespace bvh4 {

// rt_device_build::elements and pack.
uint64_t device_elements(rt_u32 slot, uint64_t count, const double* params);
int32_t device_pack(const rt_host* host, const rt_device_plan* plan, const rt_device_input* input,
                    const rt_device_topology* topology, const rt_device_output* out);

}  // namespace bvh4
