#include "tools/bench/scenes/animations.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "base/angle.hpp"
#include "base/error.hpp"
#include "base/parallel_for.hpp"
#include "scene/motion/pose_time.hpp"

namespace clarity::bench {
namespace {

constexpr unsigned kCopies = 400, kCopiesInRow = 20;

// ---- a walk

double smooth(double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * (3 - 2 * x);
}

// Legs and arms swing about an axis across the model, at 45 % and 75 % of its height; the left ones against the right ones.
void walk(float* p, const Bounds& box, double phase) {
    const double height = double(box.max[1]) - box.min[1], width = double(box.max[0]) - box.min[0];
    if (!(height > 0) || !(width > 0)) return;
    const double up = (p[1] - box.min[1]) / height, aside = 2 * (p[0] - box.min[0]) / width - 1;
    const double left = 2 * smooth(0.5 + 2 * aside) - 1;
    const bool leg = up < 0.5;
    const double joint = box.min[1] + (leg ? 0.45 : 0.75) * height;
    const double limb = leg ? smooth((0.5 - up) / 0.15) : smooth(3 * (std::fabs(aside) - 0.4)) * smooth((0.8 - up) / 0.1);
    const double angle = 0.5 * std::sin(kTurn * phase) * left * limb * (leg ? 1 : -1), c = std::cos(angle), s = std::sin(angle);
    const double y = p[1] - joint, mz = 0.5 * (double(box.min[2]) + box.max[2]), z = p[2] - mz;
    p[1] = static_cast<float>(joint + c * y - s * z + 0.02 * height * std::fabs(std::sin(kTurn * phase)));
    p[2] = static_cast<float>(mz + s * y + c * z);
}

template <class Move>
Pose each_vertex(const Scene& scene, const Move& move) {
    Pose pose = pose_at_rest(scene);
    for (rt_u32 m = 0; m < scene.meshes.size(); ++m) {
        MeshToMove mesh = mesh_to_move(scene, m);
        for (rt_u32 v = 0; v < scene.meshes[m].vertex_count; ++v) move(&mesh.posed.positions[3 * size_t(v)], mesh.box, v);
        pose.meshes.push_back(std::move(mesh.posed));
    }
    return pose;
}

// ---- an explosion

// Each triangle gets three vertices of its own.
Scene single_triangles(const Scene& scene) {
    Scene soup = scene;
    soup.positions.clear();
    soup.normals.clear();
    soup.uvs.clear();
    soup.colors = {};
    std::vector<rt_u32>& corners = soup.triangles.own();
    for (Mesh& mesh : soup.meshes) {
        const rt_u32 first = soup.vertex_count();
        for (size_t i = 3 * size_t(mesh.first_triangle); i < 3 * size_t(mesh.first_triangle + mesh.triangle_count); ++i) {
            const float* p = &scene.positions[3 * size_t(scene.triangles[i])];
            corners[i] = soup.vertex_count();
            soup.positions.append(p, p + 3);
        }
        mesh.first_vertex = first;
        mesh.vertex_count = soup.vertex_count() - first;
    }
    for (Material& material : soup.materials) material.values.texture = RT_NONE;
    return soup;
}

Pose exploded(const Scene& scene, unsigned frame) {
    std::array<float, 3> way{};
    std::mt19937 random(1);
    std::uniform_real_distribution<float> any(-1, 1);
    const double time = double(frame) / kAnimationFrames;
    return each_vertex(scene, [&](float* p, const Bounds& box, rt_u32 vertex) {
        const double size = box.diagonal();
        if (vertex % 3 == 0)
            for (int k = 0; k < 3; ++k) {
                const float center = 0.5f * (box.min[k] + box.max[k]);
                way[k] = static_cast<float>((p[k] - center) / size + 0.3 * double(any(random)));
            }
        for (int k = 0; k < 3; ++k) p[k] += static_cast<float>(0.5 * time * size * double(way[k]));
        p[1] -= static_cast<float>(0.1 * size * time * time);
    });
}

// ---- a crowd

Scene crowd(const Scene& scene) {
    Scene many = scene;
    many.instances.clear();
    for (unsigned i = 0; i < kCopies; ++i) {
        Instance copy = scene.instances.front();
        copy.apart = true;
        many.instances.push_back(copy);
    }
    return many;
}

Pose crowded(const Scene& scene, unsigned frame) {
    Pose pose = pose_at_rest(scene);
    const Mesh& mesh = scene.meshes[scene.instances.front().mesh];
    Bounds box;
    for (rt_u32 v = 0; v < mesh.vertex_count; ++v) box.add(&scene.positions[3 * size_t(mesh.first_vertex + v)]);
    const double size = box.diagonal(), scale = 1.6 / kCopiesInRow;
    std::mt19937 random(2);
    std::uniform_real_distribution<double> any(0, 1);
    for (unsigned i = 0; i < pose.instances.size(); ++i) {
        const double radius = (0.1 + 0.4 * any(random)) * size, turns = 0.5 + 2.5 * any(random), begin = any(random);
        const double angle = kTurn * (begin + turns * frame / kAnimationFrames);
        const auto column = i % kCopiesInRow, row = i / kCopiesInRow;
        const double x = (double(column) / kCopiesInRow - 0.5) * size, z = (double(row) / kCopiesInRow - 0.5) * size;
        const double c = std::cos(angle) * scale, s = std::sin(angle) * scale;
        const double at[3] = {x + radius * std::cos(angle), 0.25 * size * std::sin(angle + 3 * begin),
                              z + radius * std::sin(angle)};
        const double middle[3] = {0.5 * (double(box.min[0]) + box.max[0]), 0.5 * (double(box.min[1]) + box.max[1]),
                                  0.5 * (double(box.min[2]) + box.max[2])};
        pose.instances[i].world_from_object = {float(c),  0,
                                               float(s),  float(middle[0] + at[0] - c * middle[0] - s * middle[2]),
                                               0,         float(scale),
                                               0,         float(middle[1] + at[1] - scale * middle[1]),
                                               float(-s), 0,
                                               float(c),  float(middle[2] + at[2] + s * middle[0] - c * middle[2])};
    }
    return pose;
}

// ---- the file's own

Pose of_its_clip(const Scene& scene, unsigned frame) {
    const std::vector<ClipInfo> all = playable_clips(scene);
    if (all.empty()) throw Error(Exit::usage, "the file has no clip to play");
    const ClipInfo& clip = all.front();
    const double length = clip.end_s - clip.begin_s, time_s = frame / frame_rate(clip);
    return evaluate(scene, clip.name, clip.begin_s + (length > 0 ? std::fmod(time_s, length) : 0));
}

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

const std::vector<std::string>& animation_names() {
    static const std::vector<std::string> names = {"walk", "twist", "explosion", "crowd"};
    return names;
}

Scene staged(const Scene& scene, const std::string& animation) {
    if (animation == "explosion") return single_triangles(scene);
    if (animation == "crowd") return crowd(scene);
    return scene;
}

Pose animated_pose(const Scene& scene, const std::string& animation, unsigned frame) {
    if (animation == "explosion") return exploded(scene, frame);
    if (animation == "crowd") return crowded(scene, frame);
    if (animation == kOwnClip) return of_its_clip(scene, frame);
    if (animation == "twist") return moved_pose(scene, "twist", frame / 100.0);
    return each_vertex(scene, [&](float* p, const Bounds& box, rt_u32) { walk(p, box, frame / 25.0); });
}

const std::vector<std::string>& motion_names() {
    static const std::vector<std::string> names = {"wave", "twist"};
    return names;
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
