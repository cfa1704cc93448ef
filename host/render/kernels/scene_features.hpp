// scene_features.hpp -- which kinds of things a scene has. Kernels are compiled without the code for the others.
#pragma once
#include "render/accel/build_scene.hpp"

namespace clarity {

struct SceneFeatures {
    bool instances = false, spheres = false, polygons = false, planes = false, normals = false, uvs = false, textures = false;
};
SceneFeatures features_of(const Scene& scene, const BuildScene& build);

}  // namespace clarity
