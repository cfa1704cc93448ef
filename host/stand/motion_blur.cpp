#include "stand/motion_blur.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "launch/device_scene.hpp"
#include "launch/prepared.hpp"
#include "moving/moved_instances.hpp"
#include "moving/on_host/host_mover.hpp"
#include "scene/camera.hpp"
#include "view/edit/edit.hpp"
#include "view/view.hpp"

namespace clarity {
namespace {

bool same_geometry(const Pose& a, const Pose& b) {
    const auto same_instance = [](const PosedInstance& x, const PosedInstance& y) {
        return x.mesh == y.mesh && x.visible == y.visible && x.world_from_object == y.world_from_object;
    };
    const auto same_mesh = [](const PosedMesh& x, const PosedMesh& y) {
        return x.mesh == y.mesh && x.positions == y.positions && x.normals == y.normals;
    };
    return std::equal(a.instances.begin(), a.instances.end(), b.instances.begin(), b.instances.end(), same_instance) &&
           std::equal(a.meshes.begin(), a.meshes.end(), b.meshes.begin(), b.meshes.end(), same_mesh);
}

}  // namespace

MotionBlur::MotionBlur(Source source, const Shutter& shutter, std::shared_ptr<const MultiPrepared> prepared)
    : source_(std::move(source)), shutter_(shutter), prepared_(std::move(prepared)) {}
MotionBlur::~MotionBlur() = default;

Pose MotionBlur::pose_at(double time_s) const {
    return evaluate(*source_.rest, source_.clip, time_s, source_.read);
}

const MotionBlur::Sample& MotionBlur::at(unsigned sample, const View& view, Progress& progress) {
    const double time_s = sample_time(shutter_, sample);
    if (!first_) first_ = pose_at(shutter_.time_s);
    Pose pose = pose_at(time_s);
    if (same_geometry(pose, *first_)) {
        sample_.prepared = prepared_;
    } else if (!sample_.prepared || !same_geometry(pose, last_)) {
        sample_.prepared.reset();  // its structure is written next
        sample_.prepared = prepare(pose, progress);
    }
    sample_.view = std::make_shared<View>(view_at(view, pose));
    sample_.time_s = time_s;
    last_ = std::move(pose);
    return sample_;
}

std::shared_ptr<const MultiPrepared> MotionBlur::prepare(const Pose& pose, Progress& progress) {
    if (auto refitted = refit(pose, progress)) {
        ++refitted_;
        return refitted;
    }
    ++built_;
    Scene scene = posed(*source_.rest, pose);
    return source_.prepare(std::make_shared<const Scene>(std::move(scene)), progress);
}

// nullptr: the structure cannot follow.
std::shared_ptr<const MultiPrepared> MotionBlur::refit(const Pose& pose, Progress& progress) {
    const Prepared& first = *prepared_->first();
    if (first.settings.poses == "build" || moves_flattened_mesh(pose, *first.scene, first.accel->scene)) return nullptr;
    if (!moving_) moving_ = std::make_unique<HostMover>(first.scene, first.accel);
    const MovedStructure moved = moving_->move(pose, progress);
    if (!moved.accel) return nullptr;
    auto result = std::make_shared<MultiPrepared>();
    for (const MultiPrepared::Part& part : prepared_->parts) {
        auto prepared = std::make_shared<Prepared>(*part.prepared);
        prepared->accel = moved.accel;
        prepared->on_device =
            std::make_shared<DeviceScene>(*part.device, part.prepared->on_device, moved.accel, pose.meshes, progress);
        result->parts.push_back({part.device, prepared});
    }
    return result;
}

// What the user moved himself is none of the scene's and stays.
View MotionBlur::view_at(const View& view, const Pose& pose) const {
    View moved = view;
    for (size_t i = 0; i < pose.cameras.size(); ++i)
        if (same_camera(view.camera, first_->cameras[i])) {
            moved.camera = pose.cameras[i];
            break;
        }
    // Lights that are off are left out of a view, the others keep their order.
    size_t next = 0;
    for (rt_light& light : moved.lights)
        for (size_t i = next; i < pose.lights.size(); ++i)
            if (std::memcmp(&light, &first_->lights[i].values, sizeof light) == 0) {
                light = pose.lights[i].values;
                next = i + 1;
                break;
            }
    return moved;
}

}  // namespace clarity
