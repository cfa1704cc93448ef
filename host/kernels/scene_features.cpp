#include "kernels/scene_features.hpp"

#include <algorithm>
#include <cmath>

#include "scene/usable.hpp"
#include "view/view.hpp"

namespace clarity {

static_assert(RT_WRAP_REPEAT == 0 && RT_WRAP_CLAMP == 1 && RT_WRAP_MIRROR == 2, "cl/shading/textures.h has these numbers");

namespace {

// Scenes whose farthest coordinate is between these need no scale. Beyond, lengths of `cwbvh`, 1024 times a coordinate, times a
// reciprocal of 2^80 would be no float. Below, products of three lengths lose digits.
constexpr float kLeastReach = 0x1p-30f, kMostReach = 0x1p36f;

// The exponent of the power of two by which the scene is larger than a usual one, or smaller than 1.
int scale_of(const BuildScene& build) {
    float reach = 0;
    for (const Bounds* box : {&build.bounds, &build.object_bounds})
        for (int k = 0; k < 3 && !box->empty; ++k) reach = std::max({reach, std::fabs(box->min[k]), std::fabs(box->max[k])});
    if (reach < kLeastReach) return reach > 0 ? std::max(std::ilogb(reach), -60) : 0;
    // Boxes of spheres and shapes may be larger than any coordinate, even infinite. Traversals then enter them always.
    return reach > kMostReach ? std::ilogb(std::min(reach, 4 * kMostCoordinate) / kMostReach) + 1 : 0;
}

}  // namespace

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
    f.scale = scale_of(build);
    f.optics = optics_of(scene) | more;
    return f;
}

}  // namespace clarity
