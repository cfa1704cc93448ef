// model_checks.hpp -- whether the three functions of a model of surfaces (rt_surface.h) agree with each other, and with
// physics.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "check/steps.hpp"
#include "device/device.hpp"
#include "rt_plugin.h"

namespace clarity::check {

// open: opens the device on first use. seed: see seed.hpp.
std::vector<Check> model_checks(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open, bool quick,
                                uint64_t seed);

}  // namespace clarity::check
