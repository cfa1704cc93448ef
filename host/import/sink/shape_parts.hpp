// shape_parts.hpp -- runs a shape's plugin on the values of one shape, and takes over the parts that it makes.
#pragma once
#include <string>

#include "base/progress.hpp"
#include "rt_plugin.h"
#include "scene/scene.hpp"

namespace clarity::import {

// Appends the parts to the scene; `shape` gets their range. speaker: begins messages, "main.scene:3:1: cylinder". Throws
// Error(import_failed) if the values do not fit the plugin's keys or the plugin refuses them, and Cancelled.
void add_shape_parts(const rt_primitive& primitive, const rt_primitive_desc& desc, const std::string& speaker,
                     Progress& progress, Scene& scene, Shape& shape);

}  // namespace clarity::import
