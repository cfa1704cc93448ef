// moving_scenes.hpp -- a scene that moves, its poses and its structures, for tests of refits.
#pragma once
#include <cmath>
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"
#include "stand/ray_sets.hpp"
#include "structures/accel_build.hpp"
#include "support/generated.hpp"
#include "support/workbench.hpp"

namespace clarity::test {

inline Affine moved_to(float x, float y, float z) {
    return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z};
}

// A ring that is placed once where it is, a ball that is placed once elsewhere, a box that is placed many times, and a sphere.
inline ScenePtr rings() {
    static const ScenePtr scene = [] {
        Scene s = scene_of(torus(2, 0.7, 48, 32));
        place(s, add_mesh(s, uv_sphere(1, 24, 16)), moved_to(4, 1, 0));
        const rt_u32 cube = add_mesh(s, box(0.5));
        for (int i = 0; i < 12; ++i) place(s, cube, moved_to(-5 + float(i), 3, 1));
        s.spheres.push_back({{0, -3, 0}, 0.5f, 0});
        for (size_t i = 1; i < s.instances.size(); ++i) s.instances[i].name = "placed " + std::to_string(i);
        return shared_scene(std::move(s));
    }();
    return scene;
}

// Rays from far around towards the middle.
inline std::vector<rt_ray> rays_at_rings(int count) {
    RayMaker make(3, 0);
    std::vector<rt_ray> rays;
    for (int i = 0; i < count; ++i) rays.push_back(make.into({"the middle", {0, 0, 0}, 4}, 3));
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
