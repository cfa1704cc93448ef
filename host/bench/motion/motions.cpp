#include "bench/motion/motions.hpp"

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

Pose pose_at_rest(const Scene& scene) {
    Pose pose;
    for (const Instance& instance : scene.instances)
        pose.instances.push_back({instance.mesh, instance.world_from_object, instance.visible});
    pose.cameras = scene.cameras;
    pose.lights = scene.lights;
    return pose;
}

MeshToMove mesh_to_move(const Scene& scene, rt_u32 mesh) {
    const Mesh& range = scene.meshes[mesh];
    const auto begin = scene.positions.begin() + 3 * std::ptrdiff_t(range.first_vertex);
    MeshToMove made{{mesh, {begin, begin + 3 * std::ptrdiff_t(range.vertex_count)}, {}}, {}};
    for (size_t v = 0; v < made.posed.positions.size(); v += 3) made.box.add(&made.posed.positions[v]);
    return made;
}

Pose moved_pose(const Scene& scene, const std::string& motion, double phase) {
    const Mover move = motion == "wave" ? wave : twist;
    Pose pose = pose_at_rest(scene);
    for (rt_u32 m = 0; m < scene.meshes.size(); ++m) {
        const rt_u32 count = scene.meshes[m].vertex_count;
        MeshToMove mesh = mesh_to_move(scene, m);
        parallel_for((count + kVerticesPerTask - 1) / kVerticesPerTask, [&](uint32_t task) {
            const rt_u32 end = std::min(count, (task + 1) * kVerticesPerTask);
            for (rt_u32 v = task * kVerticesPerTask; v < end; ++v) move(&mesh.posed.positions[3 * size_t(v)], mesh.box, phase);
        });
        pose.meshes.push_back(std::move(mesh.posed));
    }
    return pose;
}

}  // namespace clarity::bench
