#include "tools/bench/motion/moving_frames.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/angle.hpp"
#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/statistics.hpp"
#include "device/cl_errors.hpp"
#include "tools/bench/scenes/animations.hpp"
#include "view/view.hpp"

namespace clarity::bench {
namespace {

constexpr unsigned kFrames = 20;          // of a call
constexpr unsigned kFramesOfAWave = 100;  // until it begins again
constexpr uint64_t kSerialVertices = 4096;

constexpr const char* kWave =
    R"(/* Writes vertices first .. first + count - 1: `rest` plus a wave along x + z, in y. size: of the scene; phase: 0 to 1. */
RT_BUILD_KERNEL wave_vertices(const global float *rest, global float *positions, uint first, uint count, uint each, float size, float phase)
{
    const uint begin = first + RT_GROUP_NUMBER * each, end = min(begin + each, first + count);
    for (uint v = begin + RT_ITEM; v < end; v += RT_GROUP) {
        float3 p = vload3(v, rest);
        p.y += 0.03f * size * sinpi(2.0f * (4.0f * (p.x + p.z) / size + phase));
        vstore3(p, v, positions);
    }
}
)";

// The scene with an octahedron in the middle of its box, which is the last instance. Its size is a fiftieth of the scene's.
Scene with_object(Scene scene) {
    const Bounds box = scene.bounds();
    const float radius = static_cast<float>(box.diagonal()) / 100;
    Mesh mesh;
    mesh.first_vertex = scene.vertex_count();
    mesh.vertex_count = 6;
    mesh.first_triangle = scene.triangle_count();
    mesh.triangle_count = 8;
    for (int v = 0; v < 6; ++v)
        for (int a = 0; a < 3; ++a) {
            const float at = v / 2 == a ? (v % 2 ? -radius : radius) : 0;
            scene.positions.push_back(at);
            if (!scene.normals.empty()) scene.normals.push_back(0);
            if (!scene.uvs.empty() && a < 2) scene.uvs.push_back(0);
            if (!scene.uvs2.empty() && a < 2) scene.uvs2.push_back(0);
        }
    if (!scene.colors.empty()) scene.colors.resize(4 * size_t(scene.vertex_count()), 1.0f);
    for (rt_u32 t = 0; t < 8; ++t) {
        const rt_u32 x = t & 1, y = 2 + (t >> 1 & 1), z = 4 + (t >> 2 & 1);
        const bool turned = (t ^ t >> 1 ^ t >> 2) & 1;
        for (const rt_u32 corner : {x, turned ? z : y, turned ? y : z}) scene.triangles.push_back(mesh.first_vertex + corner);
        scene.triangle_materials.push_back(0);
    }
    Instance instance;
    instance.mesh = static_cast<rt_u32>(scene.meshes.size());
    instance.apart = true;
    for (int a = 0; a < 3; ++a) instance.world_from_object[4 * a + 3] = 0.5f * (box.min[a] + box.max[a]);
    scene.meshes.push_back(mesh);
    scene.instances.push_back(instance);
    return scene;
}

}  // namespace

MovingFrames::MovingFrames(const PluginRegistry& plugins, std::shared_ptr<Device> device, const Scene& scene,
                           const Settings& settings, const View& view, Motion motion, Progress& progress)
    : device_(std::move(device)),
      settings_(with_optics(settings, scene, view)),
      view_(view),
      kind_(motion),
      kernels_(device_),
      frames_({device_}) {
    if (plays_clip()) rest_scene_ = std::make_shared<const Scene>(scene);
    scene_ = staged(scene);
    const bool waves = kind_ == Motion::wave_refitted || kind_ == Motion::wave_built;
    size_ = static_cast<float>(scene.bounds().diagonal());
    MultiPreparer preparer(plugins, {device_});
    prepared_ = preparer.prepare(scene_, settings_, progress);
    motion_ = std::make_unique<DeviceMover>(device_, scene_, prepared().accel, prepared().on_device, rest_scene_);
    if (motion_->cannot()) throw Error(Exit::usage, motion_->cannot().text());
    if (builds() && !motion_->can_build()) throw Error(Exit::usage, "accel " + settings_.accel + " is not built by devices");
    const MovedOnDevice first = motion_->move(plays_clip() ? clip_pose(0)
                                              : waves      ? moved_pose(scene, "wave", 0.1)
                                                           : pose_of(0),
                                              builds() ? DeviceMover::Update::build : DeviceMover::Update::refit);
    if (!first.on_device) throw Error(Exit::usage, "the structure cannot follow: " + first.why);
    MovedStructure moved;
    moved.accel = motion_->accel();
    moved.on_devices = {{device_, first.on_device}};
    moved.by_devices = true;
    prepared_ = preparer.prepare(scene_, settings_, progress, moved);
    if (!waves) return;
    wave_ = cl::Kernel(kernels_.compile(kWave, "the wave"), "wave_vertices");
    const size_t bytes = scene.positions.size() * sizeof(float);
    rest_ = kernels_.buffer(bytes);
    device_->queue().enqueueWriteBuffer(rest_, CL_TRUE, 0, bytes, scene.positions.data());
}

std::shared_ptr<const Scene> MovingFrames::staged(const Scene& scene) const {
    if (plays_clip()) return std::make_shared<const Scene>(posed(scene, clip_pose(0)));
    const bool object = kind_ == Motion::object || kind_ == Motion::nothing;
    auto moving = std::make_shared<Scene>(object ? with_object(scene) : scene);
    if (!object)
        for (Instance& instance : moving->instances) instance.apart = true;
    return moving;
}

// The first clip of the file, again and again.
Pose MovingFrames::clip_pose(unsigned frame) const {
    const std::vector<ClipInfo> all = clips(*rest_scene_);
    if (all.empty()) throw Error(Exit::usage, "the scene has no clip");
    const double length = all[0].end_s - all[0].begin_s, time = frame / (all[0].fps > 0 ? all[0].fps : 24);
    const double time_s = all[0].begin_s + (length > 0 ? std::fmod(time, length) : 0);
    return kind_ == Motion::clip_sent ? evaluate(*rest_scene_, all[0].name, time_s)
                                      : evaluate_without_vertices(*rest_scene_, all[0].name, time_s);
}

// The object on a circle around its place.
Pose MovingFrames::pose_of(float phase) const {
    Pose pose = pose_at_rest(*scene_);
    Affine& at = pose.instances.back().world_from_object;
    const float turn = static_cast<float>(kTurn) * phase;
    at[3] += 0.2f * size_ * std::cos(turn);
    at[11] += 0.2f * size_ * std::sin(turn);
    return pose;
}

// Enqueues the update of the structure.
MovedOnDevice MovingFrames::move(float phase) {
    if (kind_ == Motion::object) return motion_->move(pose_of(phase));
    for (rt_u32 m = 0; m < scene_->meshes.size(); ++m) motion_->touch(m);
    return motion_->update(builds() ? DeviceMover::Update::build : DeviceMover::Update::refit);
}

cl::Event MovingFrames::deform(float phase) {
    const uint64_t count = scene_->positions.size() / 3, each = kernels_.serial() ? kSerialVertices : kernels_.group();
    wave_.setArg(0, rest_);
    wave_.setArg(1, motion_->vertices());
    wave_.setArg(2, cl_uint{0});
    wave_.setArg(3, static_cast<cl_uint>(count));
    wave_.setArg(4, static_cast<cl_uint>(each));
    wave_.setArg(5, size_);
    wave_.setArg(6, phase);
    return kernels_.launch(wave_, (count + each - 1) / each);
}

Sample MovingFrames::play(Progress& progress) {
    return wrap_cl_errors(*device_, "playing a wave", [&] {
        double pose_ms = 0, deform_ms = 0, update_ms = 0, trace_ms = 0;
        const auto begin = std::chrono::steady_clock::now();
        for (unsigned i = 0; i < kFrames; ++i, ++next_) {
            const float phase = float(next_ % kFramesOfAWave) / kFramesOfAWave;
            auto now = std::make_shared<Prepared>(prepared());
            cl::Event deformed;
            MovedOnDevice moved;
            if (wave_()) deformed = deform(phase);
            if (plays_clip()) {
                const auto pose_begin = std::chrono::steady_clock::now();
                const Pose pose = clip_pose(next_);
                pose_ms += ms_since(pose_begin);
                moved = motion_->move(pose, builds() ? DeviceMover::Update::build : DeviceMover::Update::refit);
            } else if (kind_ != Motion::nothing) {
                moved = move(phase);
            }
            if (kind_ != Motion::nothing && !moved.on_device)
                throw Error(Exit::failed, "the structure cannot follow: " + moved.why);
            if (moved.on_device) now->on_device = moved.on_device;
            const auto shown = std::make_shared<MultiPrepared>();
            shown->parts = {{device_, now}};
            trace_ms += frames_.trace(shown, settings_, view_, 0, false, progress).device_ms;
            if (moved.on_device) update_ms += span_ms(moved.begin, moved.end, moved.ms);
            if (deformed()) deform_ms += event_ms(deformed);
        }
        Sample sample;
        sample.wall_ms = ms_since(begin) / kFrames;
        pose_ms_.push_back(pose_ms / kFrames);
        deform_ms_.push_back(deform_ms / kFrames);
        update_ms_.push_back(update_ms / kFrames);
        trace_ms_.push_back(trace_ms / kFrames);
        sample.time_ms = deform_ms_.back() + update_ms_.back() + trace_ms_.back();
        return sample;
    });
}

Parts MovingFrames::parts() const {
    return {{plays_clip() ? "pose" : "deform", median(plays_clip() ? pose_ms_ : deform_ms_)},
            {"update", median(update_ms_)},
            {"trace", median(trace_ms_)}};
}

}  // namespace clarity::bench
