// scene_features.hpp -- which kinds of primitives and attributes a scene has. Kernels contain no code for the others.
#pragma once
#include "render/accel/build_scene.hpp"

namespace clarity {

struct SceneFeatures {
    bool instances = false, spheres = false, polygons = false, planes = false, normals = false, uvs = false, textures = false,
         shapes = false;
    bool sky_picture = false;
    bool colors = false;  // vertices have colours
    bool wraps = false;   // a texture is clamped or mirrored somewhere; otherwise all repeat
};
SceneFeatures features_of(const Scene& scene, const BuildScene& build);

}  // namespace clarity
