// lights_cameras.hpp -- converts lights and cameras. The node with the same name gives each its place.
#pragma once
#include <assimp/scene.h>

#include "materials.hpp"
#include "nodes.hpp"
#include "rt_plugin.h"

namespace assimp_import {

void add_lights(const aiScene& scene, const NodeTree& tree, const rt_host& host, const rt_scene_sink& sink);
void add_cameras(const aiScene& scene, const NodeTree& tree, const rt_scene_sink& sink);

}  // namespace assimp_import
