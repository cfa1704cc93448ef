// scene_features.hpp -- which kinds of primitives, attributes, lights and surfaces a scene has. Kernels contain no code for the
// others.
#pragma once
#include "structures/build_scene.hpp"
#include "view/settings/optics.hpp"

namespace clarity {

struct SceneFeatures {
    bool instances = false, spheres = false, polygons = false, planes = false, normals = false, uvs = false, textures = false,
         shapes = false;
    bool masks = false;  // an instance is passed by some kinds of rays
    bool sky_picture = false;
    bool colors = false;      // vertices have colours
    bool maps = false;        // a material has textures besides a plain one of its colour
    bool mips = false;        // a texture has smaller pictures
    bool tangents = false;    // a map of normals is one of them
    bool uvs2 = false;        // they may name a second set of texture coordinates
    bool light_tree = false;  // lights are picked by one: see has_light_tree()
    bool wraps = false;       // a texture is clamped or mirrored somewhere; otherwise all repeat
    int scale = 0;            // RT_SCENE_SCALE is 2 to this power
    Optics optics;
};
// more: what views have that the scene's own has not.
SceneFeatures features_of(const Scene& scene, const BuildScene& build, const Optics& more = {});

}  // namespace clarity
