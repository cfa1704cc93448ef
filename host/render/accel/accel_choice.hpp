// accel_choice.hpp -- which structure holds the scene: "bvh2,max_leaf=4" as settings, and what is taken where none is named.
#pragma once
#include <string>
#include <vector>

#include "device/device.hpp"
#include "plugin/registry.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

// Sets accel and accel_params. Throws Error(usage) for an unknown structure, listing those there are, or parameter.
void choose_accel(const PluginRegistry& plugins, const std::string& text, Settings& settings);

enum class DeviceKind { cpu, gpu };
// Structures by their merit on a device of that kind, the best first; of equal ones the first by id.
std::vector<const rt_plugin*> accels_by_merit(const PluginRegistry& plugins, DeviceKind kind);
// The first of them. Throws Error(usage) if no structure was loaded.
const rt_plugin& best_accel(const PluginRegistry& plugins, DeviceKind kind);
// Of devices that share a picture, the kind that a structure is chosen for: gpu if there is one among them.
DeviceKind kind_of(const std::vector<DeviceInfo>& devices);

// Id of the best structure for a device, as --device names it. Where that names none, for a CPU: opening it reports the error.
std::string default_accel(const PluginRegistry& plugins, const std::string& device);

// The structure that settings name, or, if they name none, the best for such a device, whose id and default parameters they
// then get. Throws Error(usage) for an unknown one, listing those there are.
const rt_plugin& resolve_accel(const PluginRegistry& plugins, DeviceKind kind, Settings& settings);

}  // namespace clarity
