// accel_choice.hpp -- "bvh2,max_leaf=4" as settings.
#pragma once
#include <string>

#include "plugin/registry.hpp"
#include "render/settings/settings.hpp"

namespace clarity {

// Sets accel and accel_params. Throws Error(usage) for an unknown structure, listing those there are, or parameter.
void choose_accel(const PluginRegistry& plugins, const std::string& text, Settings& settings);

// What a device traces fastest over all scenes that were measured (docs/performance.md). device: as --device has it; where it
// names none, or CPUs alone, or the plugin is missing, the default of Settings.
std::string default_accel(const PluginRegistry& plugins, const std::string& device);

}  // namespace clarity
