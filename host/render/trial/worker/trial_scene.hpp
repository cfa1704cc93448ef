// trial_scene.hpp -- the small scene on which kernels are tried. It is made by formula.
#pragma once
#include <vector>

#include "render/kernels/scene_features.hpp"
#include "render/trial/trial_shapes.hpp"
#include "scene/scene.hpp"

namespace clarity {

// About 1000 triangles, an object of glass and a mirror, one light and a camera. It has instances, spheres, polygons, planes,
// normals, texture coordinates and textures as the features say, so that its kernels are those of any scene with them. kinds:
// those of the shapes, which are added, too.
Scene trial_scene(const SceneFeatures& features, const std::vector<ShapeKind>& kinds, const std::vector<TrialShape>& shapes);

}  // namespace clarity
