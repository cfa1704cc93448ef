// device_checks.hpp -- whether a structure's plans for the device that traces (rt_device.h) make sound trees.
#pragma once
#include <functional>
#include <memory>

#include "device/device.hpp"
#include "rt_plugin.h"
#include "structures/judging.hpp"
#include "tools/check/steps.hpp"

namespace clarity::check {

// "in groups of 256 work-items"
const char* form_text(BuildForm form);

// The check of one structure. open: opens the device on first use.
Check device_check(const rt_plugin& plugin, const std::function<std::shared_ptr<Device>()>& open, bool quick);

}  // namespace clarity::check
