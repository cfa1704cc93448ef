// judging.hpp -- what judges of builders need, who run them by themselves: their memory between guard pages, topologies, and
// what they plan on a device.
#pragma once
#include "structures/guarded_build.hpp"
#include "structures/on_device/device_blocks.hpp"
#include "structures/on_device/device_plan.hpp"
#include "structures/topology_check.hpp"
