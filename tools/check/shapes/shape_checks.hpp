// shape_checks.hpp -- whether the kernels of a shape agree with themselves: hits from all sides, for all lanes, and the surface
// there.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "device/device.hpp"
#include "rt_plugin.h"
#include "tools/check/hits/hits_checks.hpp"
#include "tools/check/steps.hpp"

namespace clarity::check {

// The checks of one shape's kernels. accel: a structure for scenes with the shape; nullptr: there is none. open: opens the
// device on first use.
std::vector<Check> shape_checks(const rt_plugin& plugin, const rt_plugin* accel,
                                const std::function<std::shared_ptr<Device>()>& open, const HitsOptions& options);

// One check for a device that looks at each access of kernels (oclgrind): few rays, and nothing is judged.
std::vector<Check> shape_access_checks(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open,
                                       const HitsOptions& options);

}  // namespace clarity::check
