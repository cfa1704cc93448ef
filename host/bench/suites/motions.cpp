#include "bench/suites/motions.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel_for.hpp"

namespace clarity::bench {
namespace {

constexpr double kTurn = 6.283185307179586;
constexpr uint32_t kVerticesPerTask = 1u << 14;

using Mover = void (*)(float* p, const Bounds& box, double phase);

void wave(float* p, const Bounds& box, double phase) {
    const double size = box.diagonal();
    p[1] += static_cast<float>(0.03 * size * std::sin(kTurn * (4 * (double(p[0]) + p[2]) / size + phase)));
}
void twist(float* p, const Bounds& box, double phase) {
    const double height = double(box.max[1]) - box.min[1], share = height > 0 ? (p[1] - box.min[1]) / height : 0;
    const double angle = kTurn / 4 * std::sin(kTurn * phase) * share, c = std::cos(angle), s = std::sin(angle);
    const double mx = 0.5 * (double(box.min[0]) + box.max[0]), mz = 0.5 * (double(box.min[2]) + box.max[2]);
    const double x = p[0] - mx, z = p[2] - mz;
    p[0] = static_cast<float>(mx + c * x + s * z);
    p[2] = static_cast<float>(mz + c * z - s * x);
}

}  // namespace

const std::vector<std::string>& motion_names() {
    static const std::vector<std::string> names = {"wave", "twist"};
    return names;
}

Pose moved_pose(const Scene& scene, const std::string& motion, double phase) {
    const Mover move = motion == "wave" ? wave : twist;
    Pose pose;
    for (const Instance& instance : scene.instances)
        pose.instances.push_back({instance.mesh, instance.world_from_object, instance.visible});
    pose.cameras = scene.cameras;
    pose.lights = scene.lights;
    for (rt_u32 m = 0; m < scene.meshes.size(); ++m) {
        const Mesh& mesh = scene.meshes[m];
        const auto begin = scene.positions.begin() + 3 * std::ptrdiff_t(mesh.first_vertex);
        PosedMesh posed{m, {begin, begin + 3 * std::ptrdiff_t(mesh.vertex_count)}, {}};
        Bounds box;
        for (size_t v = 0; v < posed.positions.size(); v += 3) box.add(&posed.positions[v]);
        parallel_for((mesh.vertex_count + kVerticesPerTask - 1) / kVerticesPerTask, [&](uint32_t task) {
            const rt_u32 end = std::min(mesh.vertex_count, (task + 1) * kVerticesPerTask);
            for (rt_u32 v = task * kVerticesPerTask; v < end; ++v) move(&posed.positions[3 * size_t(v)], box, phase);
        });
        pose.meshes.push_back(std::move(posed));
    }
    return pose;
}

}  // namespace clarity::bench
