#include "ui/session/session_view.hpp"

#include <algorithm>
#include <cmath>

#include "ui/session/camera_control.hpp"

namespace clarity::ui {
namespace {

float picture_aspect(const DesiredState& desired) {
    return static_cast<float>(desired.main.settings.width) / static_cast<float>(desired.main.settings.height);
}

}  // namespace

void focus_on(DesiredState& desired, const std::array<float, 3>& point, float nearer) {
    Camera& camera = desired.camera;
    for (int k = 0; k < 3; ++k) {
        const float away = camera.eye[k] - camera.target[k];
        camera.target[k] = point[k];
        camera.eye[k] = point[k] + away * nearer;
    }
}

void focus_on_instance(Session& session, rt_u32 instance) {
    const std::shared_ptr<const Ready> ready = session.ready();
    if (!ready || instance >= ready->scene->instances.size()) return;
    frame_bounds(session.desired.camera, instance_bounds(*whole_scene(*ready), instance), picture_aspect(session.desired));
}

void go_to(Session& session, const Camera& camera, const PoseTime& pose) {
    DesiredState& desired = session.desired;
    Playback& playback = session.playback();
    desired.camera = camera;
    if (!pose.time_s || playback.playing() || !playback.has(pose.clip)) return;
    if (pose.clip != desired.pose.clip) playback.choose(desired, pose.clip);
    desired.pose.time_s = pose.time_s;
}

void frame_selection(Session& session) {
    const std::shared_ptr<const Ready> ready = session.ready();
    if (!ready) return;
    if (session.selection.instance >= 0) return focus_on_instance(session, static_cast<rt_u32>(session.selection.instance));
    const bool at_rest = ready->scene == ready->loaded->scene;
    const Bounds bounds = at_rest ? ready->loaded->bounds : whole_scene(*ready)->bounds();
    if (!bounds.empty) frame_bounds(session.desired.camera, bounds, picture_aspect(session.desired));
}

MaterialValues& edited_material(Session& session, rt_u32 index) {
    DesiredState& desired = session.desired;
    if (desired.materials.empty())
        for (const Material& material : session.ready()->loaded->scene->materials) desired.materials.push_back(material.values);
    return desired.materials.at(index);
}

const MaterialValues& material(const Session& session, rt_u32 index) {
    const DesiredState& desired = session.desired;
    return desired.materials.empty() ? session.ready()->loaded->scene->materials.at(index).values : desired.materials.at(index);
}

float scene_size(const Session& session) {
    const std::shared_ptr<const Ready> ready = session.ready();
    const float diagonal = ready ? ready->loaded->bounds.diagonal() : 0.0f;
    if (diagonal > 0) return diagonal;
    const Camera& camera = session.desired.camera;
    float squared = 0;  // no finite bounds (only planes, or nothing): use the distance to the target
    for (int i = 0; i < 3; ++i) squared += (camera.target[i] - camera.eye[i]) * (camera.target[i] - camera.eye[i]);
    return std::max(std::sqrt(squared), 1e-3f);
}

}  // namespace clarity::ui
