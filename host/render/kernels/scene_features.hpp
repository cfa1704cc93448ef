// scene_features.hpp -- which kinds of primitives, attributes, lights and surfaces a scene has. Kernels contain no code for the
// others.
#pragma once
#include "render/accel/build_scene.hpp"
#include "render/settings/optics.hpp"

namespace clarity {

struct SceneFeatures {
    bool instances = false, spheres = false, polygons = false, planes = false, normals = false, uvs = false, textures = false,
         shapes = false;
    bool sky_picture = false;
    bool colors = false;  // vertices have colours
    bool wraps = false;   // a texture is clamped or mirrored somewhere; otherwise all repeat
    Optics optics;
};
// more: what views have that the scene's own has not.
SceneFeatures features_of(const Scene& scene, const BuildScene& build, const Optics& more = {});

}  // namespace clarity
