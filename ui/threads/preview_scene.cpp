#include "ui/threads/preview_scene.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/angle.hpp"
#include "scene/light_kinds.hpp"
#include "scene/tangents.hpp"

namespace clarity::ui {
namespace {

constexpr rt_u32 kMostTexels = 512;  // along a side of a texture

// A unit ball on the floor, of triangles: spheres have no tangents. A texture goes around it twice, so that it is not
// stretched.
void add_ball(Scene& scene) {
    constexpr rt_u32 kAround = 64, kUp = 32;
    for (rt_u32 j = 0; j <= kUp; ++j)
        for (rt_u32 i = 0; i <= kAround; ++i) {
            const double up = double(j) / kUp, around = double(i) / kAround, theta = kPi * (up - 0.5), phi = 2 * kPi * around;
            const double n[3] = {std::cos(theta) * std::sin(phi), std::sin(theta), std::cos(theta) * std::cos(phi)};
            for (int k = 0; k < 3; ++k) {
                scene.positions.push_back(static_cast<float>(n[k] + (k == 1 ? 1 : 0)));
                scene.normals.push_back(static_cast<float>(n[k]));
            }
            scene.uvs.push_back(static_cast<float>(2 * around));
            scene.uvs.push_back(static_cast<float>(up));
        }
    for (rt_u32 j = 0; j < kUp; ++j)
        for (rt_u32 i = 0; i < kAround; ++i) {
            const rt_u32 at = j * (kAround + 1) + i, above = at + kAround + 1;
            if (j > 0) scene.triangles.append(std::begin({at, at + 1, above + 1}), std::end({at, at + 1, above + 1}));
            if (j + 1 < kUp) scene.triangles.append(std::begin({at, above + 1, above}), std::end({at, above + 1, above}));
        }
    Mesh mesh;
    mesh.name = "ball";
    mesh.vertex_count = scene.vertex_count();
    mesh.triangle_count = mesh.polygon_count = scene.triangle_count();
    scene.triangle_materials.resize(scene.triangle_count(), kPreviewMaterial);
    scene.meshes.push_back(mesh);
    Instance instance;
    instance.name = mesh.name;
    scene.instances.push_back(instance);
}

// Copies textures of another scene, each once.
class Textures {
 public:
    Textures(const Scene& from, Scene& to) : from_(from), to_(to) {}
    rt_u32 copy(rt_u32 texture) {
        if (texture == RT_NONE) return RT_NONE;
        const auto [known, is_new] = copies_.emplace(texture, static_cast<rt_u32>(to_.textures.size()));
        if (!is_new) return known->second;
        rt_texture picture = from_.textures[texture];
        while (picture.levels > 0 && std::max(picture.width, picture.height) > kMostTexels) picture = smaller_picture(picture);
        const uint32_t* const texels = from_.texels.data() + picture.first;
        const auto count = static_cast<std::ptrdiff_t>(texel_count(picture));
        picture.first = static_cast<rt_u32>(to_.texels.size());
        to_.texels.append(texels, texels + count);
        to_.textures.push_back(picture);
        return known->second;
    }

 private:
    const Scene& from_;
    Scene& to_;
    std::map<rt_u32, rt_u32> copies_;
};

rt_light lamp() {
    rt_light light = default_light(RT_LIGHT_RECT);
    const float center[3] = {-2.5f, 4.5f, 2.5f}, u[3] = {0.7f, 0.5f, 0}, v[3] = {0.25f, -0.35f, 0.74f};
    std::copy_n(center, 3, light.position);
    std::copy_n(u, 3, light.u);
    std::copy_n(v, 3, light.v);
    std::fill_n(light.color, 3, 14.0f);
    make_sound(light);
    return light;
}

void set_colors(rt_f32 (&to)[3], float r, float g, float b) {
    to[0] = r, to[1] = g, to[2] = b;
}

}  // namespace

Scene preview_scene(const Scene& of, rt_u32 number) {
    Scene scene;
    Material floor;
    floor.values = default_material();
    floor.values.model = RT_MODEL_LAMBERT;
    floor.values.flags |= RT_MATERIAL_CHECKER;
    set_colors(floor.values.color, 0.5f, 0.5f, 0.5f);
    Material material = of.materials[number];
    Textures textures(of, scene);
    material.values.texture = textures.copy(material.values.texture);
    for (rt_u32& map : material.maps) {
        if (map == RT_NONE) continue;
        rt_map own = of.maps[map];
        own.texture = textures.copy(own.texture);
        own.set = 0;  // the ball has one set of coordinates
        map = static_cast<rt_u32>(scene.maps.size());
        scene.maps.push_back(own);
    }
    scene.materials = {Material{"", default_material()}, material, floor};
    add_ball(scene);
    make_tangents(scene);
    scene.planes.push_back({{0, 1, 0}, 0, 2});
    scene.lights.push_back({"lamp", lamp()});
    scene.sky.values.kind = RT_SKY_GRADIENT;
    set_colors(scene.sky.values.color, 0.35f, 0.45f, 0.6f);
    set_colors(scene.sky.values.horizon, 0.8f, 0.8f, 0.8f);
    set_colors(scene.sky.values.ground, 0.2f, 0.2f, 0.2f);
    Camera camera;
    camera.eye = {0, 1.9f, 4.6f};
    camera.target = {0, 0.92f, 0};
    camera.fov_y_rad = static_cast<float>(29 * kRadPerDegree);
    scene.cameras.push_back(camera);
    return scene;
}

}  // namespace clarity::ui
