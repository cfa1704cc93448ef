#include "ui/session/session_view.hpp"

#include <algorithm>
#include <cmath>

#include "scene/map_uses.hpp"
#include "scene/material_keys.hpp"
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

namespace {

// A factor of 0 of a use that had no texture hides the one that it gets.
void show_texture(Session& session, rt_u32 index, rt_u32 use) {
    if (session.desired.maps.texture_of(*session.ready()->loaded->scene, index, use) != RT_NONE) return;
    for (const char* const* name = map_uses()[use].multiplies.data(); *name; ++name) {
        const Key& key = material_key(*name);
        if (value_of(key, &material(session, index)) == std::array<float, 3>{})
            set_material_value(edited_material(session, index), key, nearest_value(key, {1, 1, 1}));
    }
}

}  // namespace

void give_texture(Session& session, rt_u32 material, rt_u32 use, rt_u32 texture) {
    if (texture != RT_NONE) show_texture(session, material, use);
    session.desired.maps.give(*session.ready()->loaded->scene, material, use, texture);
}

void give_picture(Session& session, rt_u32 material, rt_u32 use, const std::string& path) {
    show_texture(session, material, use);
    const std::string key = "material." + std::to_string(material) + "." + map_uses()[use].name;
    session.apply({key, path});
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
