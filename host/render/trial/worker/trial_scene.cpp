#include "render/trial/worker/trial_scene.hpp"

#include <array>
#include <cmath>

#include "base/angle.hpp"
#include "scene/material_keys.hpp"
#include "scene/surface_models.hpp"
#include "scene/tangents.hpp"

namespace clarity {
namespace {

enum : rt_u32 { kMatt, kGlass, kMirror, kTextured };

// A sphere with bumps: rows x columns pairs of triangles.
void add_bumps(Scene& scene, rt_u32 material) {
    constexpr rt_u32 kRows = 16, kColumns = 32;
    constexpr auto pi = static_cast<float>(kPi);
    Mesh mesh;
    mesh.name = "bumps";
    mesh.first_vertex = scene.vertex_count();
    mesh.first_triangle = scene.triangle_count();
    for (rt_u32 row = 0; row <= kRows; ++row)
        for (rt_u32 column = 0; column <= kColumns; ++column) {
            const float v = float(row) / kRows, u = float(column) / kColumns;
            const float up = v * pi, round = u * 2 * pi, radius = 1 + 0.1f * std::sin(5 * up) * std::cos(4 * round);
            const float direction[3] = {std::sin(up) * std::cos(round), std::cos(up), std::sin(up) * std::sin(round)};
            for (const float d : direction) scene.positions.push_back(radius * d);
            for (const float d : direction) scene.normals.push_back(d);
            scene.uvs.push_back(u);
            scene.uvs.push_back(v);
        }
    for (rt_u32 row = 0; row < kRows; ++row)
        for (rt_u32 column = 0; column < kColumns; ++column) {
            const rt_u32 a = mesh.first_vertex + row * (kColumns + 1) + column, b = a + kColumns + 1;
            for (const rt_u32 corner : {a, b, a + 1, a + 1, b, b + 1}) scene.triangles.push_back(corner);
        }
    mesh.vertex_count = scene.vertex_count() - mesh.first_vertex;
    mesh.triangle_count = scene.triangle_count() - mesh.first_triangle;
    mesh.polygon_count = mesh.triangle_count;
    scene.triangle_materials.resize(scene.triangle_count(), material);
    scene.meshes.push_back(mesh);
}

void add_floor(Scene& scene, rt_u32 material) {
    Mesh mesh;
    mesh.name = "floor";
    mesh.first_vertex = scene.vertex_count();
    mesh.first_triangle = scene.triangle_count();
    for (const float x : {-6.0f, 6.0f})
        for (const float z : {-6.0f, 6.0f}) {
            for (const float p : {x, -1.2f, z}) scene.positions.push_back(p);
            for (const float n : {0.0f, 1.0f, 0.0f}) scene.normals.push_back(n);
            scene.uvs.push_back(x);
            scene.uvs.push_back(z);
        }
    for (const rt_u32 corner : {0u, 1u, 2u, 2u, 1u, 3u}) scene.triangles.push_back(mesh.first_vertex + corner);
    mesh.vertex_count = 4;
    mesh.triangle_count = mesh.polygon_count = 2;
    scene.triangle_materials.resize(scene.triangle_count(), material);
    scene.meshes.push_back(mesh);
}

void place(Scene& scene, rt_u32 mesh, rt_u32 material, const Affine& where) {
    Instance instance;
    instance.name = scene.meshes[mesh].name;
    instance.mesh = mesh;
    instance.material = material;
    instance.world_from_object = where;
    scene.instances.push_back(instance);
}

void add_materials(Scene& scene, bool textures) {
    scene.materials.assign(4, Material{"", default_material()});
    scene.materials[kGlass].values.refract = 0.8f;
    scene.materials[kMirror].values.reflect = 0.7f;
    if (!textures) return;
    scene.materials[kTextured].values.texture = 0;
    scene.textures.push_back({0, 2, 2, 0, 0, 0, 0});
    for (const uint32_t texel : {0xFF2040C0u, 0xFFE0E0E0u, 0xFF40C020u, 0xFF808080u}) scene.texels.push_back(texel);
}

// Maps, smaller pictures, second coordinates and tangents as the features say, which the textured material has.
void add_maps(Scene& scene, const SceneFeatures& features) {
    if (features.mips) {
        scene.texels.push_back(0xFF909090u);
        scene.textures[0].levels = 1;
    }
    if (features.uvs2) scene.uvs2 = scene.uvs;
    const auto add = [&](rt_u32 use) {
        scene.materials[kTextured].maps[use] = static_cast<rt_u32>(scene.maps.size());
        scene.maps.push_back({{1, 0, 0, 0, 1, 0.5f}, 0, features.uvs2 ? 1u : 0u, 0.5f, 0});
    };
    if (features.maps) add(RT_MAP_OCCLUSION);
    if (features.tangents) add(RT_MAP_NORMAL);
    make_tangents(scene);
}

// Models that plugins bring, on every other triangle.
void add_surfaces(Scene& scene, rt_u32 lobes) {
    std::vector<rt_u32> own;
    for (const SurfaceModel& model : surface_models()) {
        if (!(lobes & lobe_of_surface(model.number))) continue;
        own.push_back(static_cast<rt_u32>(scene.materials.size()));
        scene.materials.push_back({"", default_material()});
        set_material_value(scene.materials.back().values, material_key("model"), {static_cast<float>(model.number), 0, 0});
    }
    if (own.empty()) return;
    std::vector<rt_u32> materials(scene.triangle_materials.begin(), scene.triangle_materials.end());
    for (size_t t = 0; t < materials.size(); t += 2) materials[t] = own[t / 2 % own.size()];
    scene.triangle_materials = SharedArray<rt_u32>(std::move(materials));
}

// In rows above the other objects.
void add_shapes(Scene& scene, const std::vector<TrialShape>& shapes) {
    size_t number = 0;
    for (const TrialShape& shape : shapes)
        for (rt_u32 kind = 0; kind < scene.shape_kinds.size(); ++kind) {
            if (scene.shape_kinds[kind].id != shape.id) continue;
            const size_t column = number % 5, row = number / 5;
            add_shape(scene, shape, kind, std::array{kMatt, kGlass, kMirror}[number % 3],
                      {-2.4f + 1.2f * static_cast<float>(column), 1.5f + 0.9f * static_cast<float>(row), 0.3f}, 0.45f);
            ++number;
        }
}

}  // namespace

Scene trial_scene(const SceneFeatures& features, const std::vector<ShapeKind>& kinds, const std::vector<TrialShape>& shapes) {
    Scene scene;
    add_materials(scene, features.textures);
    add_bumps(scene, kGlass);
    add_floor(scene, kTextured);
    add_surfaces(scene, features.optics.lobes);
    if (!features.normals) scene.normals = {};
    if (!features.uvs && !features.textures) scene.uvs = {};
    if (features.textures) add_maps(scene, features);
    if (features.optics.cutouts) {
        scene.materials[kMatt].values.alpha = RT_ALPHA_BLEND;
        scene.materials[kMatt].values.opacity = 0.5f;
        scene.materials[kTextured].values.alpha = RT_ALPHA_MASK;
    }
    if (features.colors)  // dim towards the last vertex
        for (rt_u32 v = 0; v < scene.vertex_count(); ++v)
            for (const float c : {1.0f, 1.0f - float(v) / scene.vertex_count(), 0.5f, 1.0f}) scene.colors.push_back(c);
    place(scene, 0, RT_NONE, kIdentity);
    place(scene, 1, RT_NONE, kIdentity);
    if (features.instances) {  // turned, stretched and mirrored
        place(scene, 0, kMirror, {0.6f, 0, 0.8f, -2.5f, 0, 0.7f, 0, 0, -0.8f, 0, 0.6f, -1});
        place(scene, 0, kMatt, {-0.8f, 0, 0, 2.4f, 0, 1.1f, 0, 0.2f, 0, 0, 0.5f, -1});
    }
    if (features.spheres) {
        scene.spheres.push_back({{-1.2f, -0.7f, 1.5f}, 0.5f, kMirror});
        scene.spheres.push_back({{1.3f, -0.8f, 1.4f}, 0.4f, kGlass});
    }
    if (features.polygons) {
        for (const float corner :
             {-3.0f, -1.0f, -3.0f, 0.0f, 0.5f, -3.0f, 3.0f, -1.0f, -3.0f, 3.0f, 3.0f, -3.0f, -3.0f, 3.0f, -3.0f})  // not convex
            scene.polygon_corners.push_back(corner);
        scene.polygons.push_back({0, 5, kMatt});
    }
    if (features.planes) scene.planes.push_back({{0, 1, 0}, -1.5f, kMatt});
    scene.shape_kinds = kinds;
    add_shapes(scene, shapes);
    Light light;
    light.values = whitted_light(RT_LIGHT_POINT, {4, 6, 5}, {40, 40, 40});
    scene.lights.push_back(light);
    Camera camera;
    camera.eye = {0, 1, 6};
    scene.cameras.push_back(camera);
    return scene;
}

}  // namespace clarity
