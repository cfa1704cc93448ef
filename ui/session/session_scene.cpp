// The parts of Session which work on the scene: inspecting and picking pixels, selecting, focusing, editing and hiding objects.
#include <algorithm>
#include <utility>

#include "base/log.hpp"
#include "ui/session/camera_control.hpp"
#include "ui/session/comparisons.hpp"
#include "ui/session/session.hpp"
#include "view/view.hpp"

namespace clarity::ui {
namespace {

// Pixels are those of the whole picture, also if a part of it is traced.
FrameJob whole_job(const Picture& picture) {
    FrameJob job = picture.job;
    job.settings = of_whole(job.settings);
    return job;
}

}  // namespace

void Session::inspect(unsigned x, unsigned y) {
    if (!picture_) return;
    inspector_.ask(whole_job(*picture_), x, y);
}

void Session::explain(unsigned x, unsigned y) {
    if (!picture_) return;
    std::vector<std::string> names;
    for (const DesiredLight& light : desired.lights)
        if (light.on) names.push_back(light.name);
    inspector_.ask_why(whole_job(*picture_), x, y, std::move(names));
}

void Session::pick(unsigned x, unsigned y) {
    if (!picture_) return;
    pick_request_ = inspector_.ask(whole_job(*picture_), x, y);
}

// Selects the object that the camera ray of the picked pixel hit.
void Session::take_pick() {
    const auto inspection = inspector_.latest();
    if (!inspection || inspection->request < pick_request_ || pick_request_ == picked_request_) return;
    picked_request_ = pick_request_;
    if (!inspection->failure.empty()) return messages_.report(inspection->failure);
    selection = {};
    if (!ready_ || inspection->job.ready->loaded != ready_->loaded || inspection->result.rays.empty()) return;
    const PrimPlace place = place_of_prim(*inspection->job.ready->scene, inspection->result.rays.front().prim);
    if (place.kind == PrimPlace::Kind::none) return;
    selection.prim = inspection->result.rays.front().prim;
    selection.instance = place.instance == RT_NONE ? -1 : static_cast<rt_i32>(place.instance);
    selection.material = place.material == RT_NONE ? -1 : static_cast<rt_i32>(place.material);
}

void Session::want_preview(rt_u32 material, unsigned size) {
    if (!ready_ || material >= ready_->scene->materials.size() || sequence_.running()) return;
    preview_wanted_ = true;
    const std::vector<MaterialValues>& edited = desired.materials;
    preview_.show({ready_, material, edited.empty() ? ready_->scene->materials[material].values : edited[material], size});
}

void Session::take_preview() {
    preview_.set_busy(!frames_.idle() || worker_.activity().busy || moving_);
    if (!std::exchange(preview_wanted_, false)) preview_.hide();
}

void Session::prepare_to_move(rt_u32 instance) {
    const auto at = std::lower_bound(apart_.begin(), apart_.end(), instance);
    if (at == apart_.end() || *at != instance) apart_.insert(at, instance);
}

std::optional<std::array<float, 3>> Session::middle_of(rt_u32 number) {
    if (!ready_ || number >= ready_->scene->instances.size()) return std::nullopt;
    const Instance& instance = ready_->loaded->scene->instances[number];
    const rt_u32 mesh = instance.node == RT_NONE ? instance.mesh : instance.moving_mesh;
    const std::array<float, 3>& pivot = middles_.of(*ready_->loaded->scene, mesh);
    std::array<float, 3> middle = transform_point(ready_->scene->instances[number].world_from_object, pivot.data());
    const InstanceShift shown = ready_->request.instances.shift_of(number), wanted = desired.instances.shift_of(number);
    for (size_t k = 0; k < 3; ++k) middle[k] += wanted.translate[k] - shown.translate[k];
    return middle;
}

void Session::reset_view() {
    if (!ready_) return;
    EditedView edited = first_view();
    edited.camera_path = desired.camera_path;
    adopt_view(edited);
}

EditedView Session::first_view_of(const Ready& ready) {
    EditedView first;
    View& view = first.view;
    view = ready.loaded->first_view;
    const Scene& rest = *ready.loaded->scene;
    for (size_t i = 0; i < rest.cameras.size(); ++i)
        if (same_camera(view.camera, rest.cameras[i])) {
            view.camera = ready.cameras[i];
            break;
        }
    for (size_t i = 0; i < std::min(view.lights.size(), rest.lights.size()); ++i)
        if (same_light(view.lights[i], rest.lights[i].values)) view.lights[i] = ready.lights[i].values;
    apply_scene_edits(rest, first);
    return first;
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
    desired.sky = view.sky;
    desired.materials = view.materials;
    desired.instances = edited.instances;
    desired.maps = edited.maps;
    desired.lights.clear();
    selected_light = 0;
    for (size_t i = 0; i < view.lights.size(); ++i) {
        std::string name = i < scene.lights.size() ? scene.lights[i].name : "";
        if (name.empty()) name = "light " + std::to_string(i + 1);
        desired.lights.push_back({name, view.lights[i], i >= edited.lights_on.size() || edited.lights_on[i]});
    }
    if (const std::string note = size_note(view.lights, desired.main.settings.tracer); !note.empty())
        log(LogLevel::warning, note);
}

}  // namespace clarity::ui
