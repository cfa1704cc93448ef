// moving_scenes.hpp -- a scene that moves, its poses and its structures, for tests of refits.
#pragma once
#include <cmath>
#include <random>
#include <vector>

#include "scene/motion/pose.hpp"
#include "structures/accel_build.hpp"
#include "support/generated.hpp"
#include "support/workbench.hpp"

namespace clarity::test {

inline Affine moved_to(float x, float y, float z) {
    return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z};
}

inline rt_u32 add_mesh(Scene& scene, const TriangleMesh& mesh) {
    Mesh range;
    range.first_vertex = scene.vertex_count();
    range.first_triangle = scene.triangle_count();
    range.vertex_count = static_cast<rt_u32>(mesh.positions.size() / 3);
    range.triangle_count = range.polygon_count = static_cast<rt_u32>(mesh.triangles.size() / 3);
    scene.positions.append(mesh.positions.begin(), mesh.positions.end());
    for (const rt_u32 v : mesh.triangles) scene.triangles.push_back(range.first_vertex + v);
    scene.triangle_materials.resize(scene.triangles.size() / 3, 0);
    scene.meshes.push_back(range);
    return static_cast<rt_u32>(scene.meshes.size() - 1);
}
inline void place(Scene& scene, rt_u32 mesh, const Affine& world_from_object) {
    Instance instance;
    instance.mesh = mesh;
    instance.world_from_object = world_from_object;
    instance.name = "placed " + std::to_string(scene.instances.size());
    scene.instances.push_back(instance);
}

// A ring that is placed once where it is, a ball that is placed once elsewhere, a box that is placed many times, and a sphere.
inline ScenePtr rings() {
    static const ScenePtr scene = [] {
        Scene s = scene_of(torus(2, 0.7, 48, 32));
        place(s, add_mesh(s, uv_sphere(1, 24, 16)), moved_to(4, 1, 0));
        const rt_u32 cube = add_mesh(s, box(0.5));
        for (int i = 0; i < 12; ++i) place(s, cube, moved_to(-5 + float(i), 3, 1));
        s.spheres.push_back({{0, -3, 0}, 0.5f, 0});
        return shared_scene(std::move(s));
    }();
    return scene;
}

// Rays from far around towards the middle.
inline std::vector<rt_ray> rays_at_rings(int count) {
    std::mt19937 random(3);
    std::normal_distribution<float> any;
    std::vector<rt_ray> rays;
    for (int i = 0; i < count; ++i) {
        rt_ray ray{{8 * any(random), 8 * any(random), 8 * any(random)}, 0, {}, INFINITY};
        float length = 0;
        for (int k = 0; k < 3; ++k) length += std::pow(ray.direction[k] = 2 * any(random) - ray.origin[k], 2.0f);
        for (float& d : ray.direction) d /= std::sqrt(length);
        rays.push_back(ray);
    }
    return rays;
}

// All vertices follow a wave, and the instances from number 2 on move.
inline Pose waved(const Scene& scene, float phase) {
    Pose pose = pose_at_rest(scene);
    for (rt_u32 m = 0; m < scene.meshes.size(); ++m) {
        const Mesh& mesh = scene.meshes[m];
        PosedMesh posed{m,
                        {scene.positions.begin() + 3 * std::ptrdiff_t(mesh.first_vertex),
                         scene.positions.begin() + 3 * std::ptrdiff_t(mesh.first_vertex + mesh.vertex_count)},
                        {}};
        for (size_t v = 0; v < posed.positions.size(); v += 3)
            posed.positions[v + 1] += 0.6f * std::sin(3 * posed.positions[v] + phase);
        pose.meshes.push_back(std::move(posed));
    }
    for (size_t i = 2; i < pose.instances.size(); ++i) pose.instances[i].world_from_object[11] += std::sin(phase + float(i));
    return pose;
}

inline std::shared_ptr<const AccelData> build(const ScenePtr& scene, const rt_plugin& plugin) {
    Progress progress;
    const rt_plugin& layout = Workbench::get().plugins().layout_of(plugin);
    return std::make_shared<AccelData>(build_accel(*scene, plugin, default_parameters(plugin), progress, {&layout}));
}

}  // namespace clarity::test
