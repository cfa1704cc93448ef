// device_build.hpp -- plans on the device: a binary tree becomes nodes of four children, and such nodes are refitted.
// bvh4_build.cl has the kernels.
#pragma once
#include "rt_device.h"

namespace bvh4 {

// The functions of rt_device_build.
uint64_t device_elements(rt_u32 slot, uint64_t count, const double* params);
int32_t device_pack(const rt_host* host, const rt_device_plan* plan, const rt_device_input* input,
                    const rt_device_topology* topology, const rt_device_tree* tree, const rt_device_output* out);
int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out);
int32_t device_refit(const rt_host* host, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params);

}  // namespace bvh4
