// mesh_scene.hpp -- a scene of the caller's arrays.
#pragma once
#include "api/clarity.h"
#include "plugin/registry.hpp"
#include "scene/scene.hpp"

namespace clarity::api {

// The scene borrows the arrays, but positions of type CLARITY_FLOAT64. Throws Error(usage) for arrays that are no mesh.
Scene scene_of_mesh(const PluginRegistry& plugins, const clarity_mesh& mesh);

}  // namespace clarity::api
