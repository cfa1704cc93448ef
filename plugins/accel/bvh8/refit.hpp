// refit.hpp -- the extension `refit` of bvh8: new volumes for primitives that moved, in the same tree.
#pragma once
#include "rt_device.h"
#include "rt_plugin.hpp"

namespace bvh8 {

int32_t refit(const rt_host* host, const rt_refit_input* in, const rt_refit_output* out);
// On the device: see rt_device.h.
int32_t device_ranges(const rt_host* host, const rt_built* built, rt_u32 group, rt_tree_ranges* out);
int32_t device_refit(const rt_host* host, const rt_device_plan* plan, const rt_device_tree* tree, rt_u32 blocks, rt_u32 costs,
                     const double* params);

}  // namespace bvh8
