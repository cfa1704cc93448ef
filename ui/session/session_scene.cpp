// The parts of Session which work on the scene: inspecting and picking pixels, selecting, focusing, editing and hiding objects.
#include <algorithm>

#include "ui/session/camera_control.hpp"
#include "ui/session/comparisons.hpp"
#include "ui/session/session.hpp"

namespace clarity::ui {

void Session::inspect(unsigned x, unsigned y) {
    if (!picture_) return;
    inspector_.ask(picture_->job, x, y);
}

void Session::pick(unsigned x, unsigned y) {
    if (!picture_) return;
    pick_request_ = inspector_.ask(picture_->job, x, y);
}

// Selects the object that the camera ray of the picked pixel hit.
void Session::take_pick() {
    const auto inspection = inspector_.latest();
    if (!inspection || inspection->request < pick_request_ || pick_request_ == picked_request_) return;
    picked_request_ = pick_request_;
    if (!inspection->failure.empty()) return report(inspection->failure);
    selection = {};
    if (!ready_ || inspection->job.ready->loaded != ready_->loaded || inspection->result.rays.empty()) return;
    const PrimPlace place = place_of_prim(*inspection->job.ready->scene, inspection->result.rays.front().prim);
    if (place.kind == PrimPlace::Kind::none) return;
    selection.prim = inspection->result.rays.front().prim;
    selection.instance = place.instance == RT_NONE ? -1 : static_cast<rt_i32>(place.instance);
    selection.material = place.material == RT_NONE ? -1 : static_cast<rt_i32>(place.material);
}

void Session::focus_on(const std::array<float, 3>& point, float nearer) {
    Camera& camera = desired.camera;
    for (int k = 0; k < 3; ++k) {
        const float away = camera.eye[k] - camera.target[k];
        camera.target[k] = point[k];
        camera.eye[k] = point[k] + away * nearer;
    }
}

void Session::focus_on_instance(rt_u32 instance) {
    if (!ready_ || instance >= ready_->scene->instances.size()) return;
    frame_bounds(desired.camera, instance_bounds(*ready_->scene, instance), picture_aspect());
}

void Session::go_to(const Camera& camera, const PoseTime& pose) {
    desired.camera = camera;
    if (!pose.time_s || playback_.playing() || !playback_.has(pose.clip)) return;
    if (pose.clip != desired.pose.clip) playback_.choose(desired, pose.clip);
    desired.pose.time_s = pose.time_s;
}

void Session::frame_selection() {
    if (!ready_) return;
    if (selection.instance >= 0) return focus_on_instance(static_cast<rt_u32>(selection.instance));
    const bool at_rest = ready_->scene == ready_->loaded->scene;
    const Bounds bounds = at_rest ? ready_->loaded->bounds : ready_->scene->bounds();
    if (!bounds.empty) frame_bounds(desired.camera, bounds, picture_aspect());
}

float Session::picture_aspect() const {
    return static_cast<float>(desired.main.settings.width) / static_cast<float>(desired.main.settings.height);
}

rt_material& Session::edited_material(rt_u32 index) {
    if (desired.materials.empty())
        for (const Material& material : ready_->loaded->scene->materials) desired.materials.push_back(material.values);
    return desired.materials.at(index);
}

const rt_material& Session::material(rt_u32 index) const {
    return desired.materials.empty() ? ready_->loaded->scene->materials.at(index).values : desired.materials.at(index);
}

bool Session::hidden(rt_u32 instance) const {
    return std::binary_search(desired.hidden.begin(), desired.hidden.end(), instance);
}

void Session::hide(rt_u32 instance, bool hidden) {
    const auto at = std::lower_bound(desired.hidden.begin(), desired.hidden.end(), instance);
    const bool is = at != desired.hidden.end() && *at == instance;
    if (hidden && !is) desired.hidden.insert(at, instance);
    if (!hidden && is) desired.hidden.erase(at);
}

void Session::reset_view() {
    if (!ready_) return;
    EditedView edited;
    edited.view = first_view();
    edited.camera_path = desired.camera_path;
    adopt_view(edited);
}

View Session::first_view() const {
    View view = ready_->loaded->first_view;
    const Scene& rest = *ready_->loaded->scene;
    for (size_t i = 0; i < rest.cameras.size(); ++i)
        if (same_camera(view.camera, rest.cameras[i])) {
            view.camera = ready_->cameras[i];
            break;
        }
    for (size_t i = 0; i < std::min(view.lights.size(), rest.lights.size()); ++i)
        if (same_light(view.lights[i], rest.lights[i].values)) view.lights[i] = ready_->lights[i].values;
    return view;
}

void Session::adopt_view(const EditedView& edited) {
    const Scene& scene = *ready_->loaded->scene;
    const View& view = edited.view;
    desired.camera = view.camera;
    desired.camera_path = edited.camera_path;
    if (!desired.camera_path.empty()) playback_.offer_stage(desired, desired.camera_path.keys.back().time_s);
    if (edited.follows_path)
        desired.camera = desired.camera_path.at(desired.pose.time_s.value_or(desired.camera_path.keys.front().time_s));
    path_time_s_.reset();
    desired.background = view.background;
    desired.ambient = view.ambient;
    desired.materials = view.materials;
    desired.hidden = edited.hidden;
    desired.lights.clear();
    selected_light = 0;
    for (size_t i = 0; i < view.lights.size(); ++i) {
        std::string name = i < scene.lights.size() ? scene.lights[i].name : "";
        if (name.empty()) name = "light " + std::to_string(i + 1);
        desired.lights.push_back({name, view.lights[i], i >= edited.lights_on.size() || edited.lights_on[i]});
    }
}

}  // namespace clarity::ui
