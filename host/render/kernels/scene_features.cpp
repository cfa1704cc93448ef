#include "render/kernels/scene_features.hpp"

#include <algorithm>

#include "render/view/view.hpp"

namespace clarity {

static_assert(RT_WRAP_REPEAT == 0 && RT_WRAP_CLAMP == 1 && RT_WRAP_MIRROR == 2, "cl/shading/textures.h has these numbers");

SceneFeatures features_of(const Scene& scene, const BuildScene& build, const Optics& more) {
    SceneFeatures f;
    f.instances = !build.instances.empty();
    f.masks = f.instances && std::any_of(scene.instances.begin(), scene.instances.end(),
                                         [](const Instance& i) { return i.mask != RT_SEEN_BY_ALL; });
    f.spheres = !build.spheres.empty();
    f.polygons = !build.polygons.empty();
    f.planes = !build.planes.empty();
    f.shapes = !build.shapes.empty();
    f.normals = !scene.normals.empty() && !build.attribute_triangle.empty();
    for (const Material& m : scene.materials) {
        f.maps = f.maps || (m.used && m.maps != no_maps());
        f.textures = f.textures || f.maps || (m.used && m.values.texture != RT_NONE);
    }
    f.wraps = f.textures && std::any_of(scene.textures.begin(), scene.textures.end(),
                                        [](const rt_texture& texture) { return texture.wrap != RT_WRAP_REPEAT; });
    f.sky_picture = scene.sky.values.kind == RT_SKY_PICTURE;
    f.colors = !scene.colors.empty() && !build.attribute_triangle.empty();
    f.uvs = !scene.uvs.empty() && !build.attribute_triangle.empty();
    f.mips = f.textures && std::any_of(scene.textures.begin(), scene.textures.end(),
                                       [](const rt_texture& texture) { return texture.levels > 0; });
    f.tangents = !scene.tangents.empty() && !build.attribute_triangle.empty();
    f.uvs2 = f.maps && !scene.uvs2.empty() && !build.attribute_triangle.empty();
    f.optics = optics_of(scene) | more;
    return f;
}

}  // namespace clarity
