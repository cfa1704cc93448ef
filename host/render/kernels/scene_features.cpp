#include "render/kernels/scene_features.hpp"

#include <algorithm>

namespace clarity {

SceneFeatures features_of(const Scene& scene, const BuildScene& build) {
    SceneFeatures f;
    f.instances = !build.instances.empty();
    f.spheres = !build.spheres.empty();
    f.polygons = !build.polygons.empty();
    f.planes = !build.planes.empty();
    f.shapes = !build.shapes.empty();
    f.normals = !scene.normals.empty() && !build.attribute_triangle.empty();
    f.textures = std::any_of(scene.materials.begin(), scene.materials.end(),
                             [](const Material& m) { return m.values.texture != RT_NONE; });
    f.uvs = !scene.uvs.empty() && !build.attribute_triangle.empty();
    return f;
}

}  // namespace clarity
