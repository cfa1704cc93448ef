// accel_choice.hpp -- chooses the acceleration structure: parses "bvh2,max_leaf=4" into settings, and finds the default.
#pragma once
#include <string>
#include <vector>

#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

// Parses "ID[,key=value...]" into settings.accel and accel_params. Throws Error(usage) for an unknown structure (the message
// lists the known ones) or an unknown parameter.
void choose_accel(const PluginRegistry& plugins, const std::string& text, Settings& settings);

enum class DeviceKind { cpu, gpu };
// Returns all structures, ordered by their merit on a device of that kind, the best first; equal ones by id.
std::vector<const rt_plugin*> accels_by_merit(const PluginRegistry& plugins, DeviceKind kind);
// Returns the first of them. Throws Error(usage) if no structure was loaded.
const rt_plugin& best_accel(const PluginRegistry& plugins, DeviceKind kind);
// Returns the kind for which the structure of a shared picture is chosen: cpu if all devices are CPUs, else gpu.
DeviceKind kind_of(const std::vector<DeviceInfo>& devices);

// Returns the id of the best structure for `device`, a text as for --device. If the text names no device, returns the best for
// a CPU; opening the device will report the error.
std::string default_accel(const PluginRegistry& plugins, const std::string& device);

// Returns the structure that the settings name. If they name none, returns the best for such a device, and puts its id and
// default parameters into the settings. Throws Error(usage) for an unknown structure; the message lists the known ones.
const rt_plugin& resolve_accel(const PluginRegistry& plugins, DeviceKind kind, Settings& settings);

}  // namespace clarity
