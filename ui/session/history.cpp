#include "ui/session/history.hpp"

#include <algorithm>
#include <cstring>

#include "ui/session/comparisons.hpp"

namespace clarity::ui {
namespace {

void compare_sides(const Side& a, const Side& b, const char* which, std::vector<std::string>& names) {
    if (a.device != b.device) names.push_back(std::string(which) + "Device");
    if (a.settings.accel != b.settings.accel)
        names.push_back(std::string(which) + "Structure");
    else if (a.settings.accel_params != b.settings.accel_params)
        names.push_back(std::string(which) + "Parameter of " + a.settings.accel);
    for (const Setting& row : settings_table())
        if (!row.equal(a.settings, b.settings)) names.push_back(which + row.label);
}

std::vector<std::string> differences(const DesiredState& a, const DesiredState& b) {
    static_assert(has_member_count<DesiredState, 18> && has_member_count<ObjectEdits, 2> && has_member_count<InstanceEdits, 3>,
                  "what undo takes back has a name here; restore() keeps the rest");
    std::vector<std::string> names;
    compare_sides(a.main, b.main, "", names);
    if (a.other.has_value() != b.other.has_value())
        names.push_back("Comparison");
    else if (a.other)
        compare_sides(*a.other, *b.other, "B: ", names);
    if (a.lights.size() != b.lights.size()) names.push_back("Number of lights");
    for (size_t i = 0; i < std::min(a.lights.size(), b.lights.size()); ++i)
        if (a.lights[i].on != b.lights[i].on || std::memcmp(&a.lights[i].values, &b.lights[i].values, sizeof(rt_light)) != 0)
            names.push_back(a.lights[i].name);
    if (a.background != b.background) names.push_back("Background");
    if (a.ambient != b.ambient) names.push_back("Ambient light");
    if (!same_edited_sky(a.sky, b.sky)) names.push_back("Sky");
    if (!same_bytes(a.materials, b.materials)) names.push_back("Material");
    if (a.maps != b.maps) names.push_back("Texture");
    if (a.instances.moved != b.instances.moved) names.push_back("Place of objects");
    if (a.instances.hidden != b.instances.hidden) names.push_back("Visibility");
    if (a.instances.masks != b.instances.masks) names.push_back("Mask");
    if (a.pose.clip != b.pose.clip)
        names.push_back("Clip");
    else if (a.loop != b.loop)
        names.push_back("Loop range");
    if (!(a.camera_path == b.camera_path)) names.push_back("Camera path");
    if (a.speed != b.speed) names.push_back("Speed");
    if (a.resolution_scale != b.resolution_scale) names.push_back("Resolution");
    if (a.moving_fps != b.moving_fps) names.push_back("Frames/s while moving");
    return names;
}

// Restores all but the camera, the time within a clip, and what is only for measuring.
void restore(DesiredState& desired, const DesiredState& from) {
    const Camera camera = desired.camera;
    const bool continuous = desired.continuous, equal_time = desired.equal_time;
    const PoseTime pose = desired.pose;
    desired = from;
    if (desired.pose.clip == pose.clip) desired.pose = pose;
    desired.camera = camera;
    desired.continuous = continuous;
    desired.equal_time = equal_time;
}

}  // namespace

std::string difference_name(const DesiredState& a, const DesiredState& b) {
    const std::vector<std::string> names = differences(a, b);
    if (names.empty()) return {};
    return names.size() == 1 ? names.front() : std::to_string(names.size()) + " changes";
}

void History::observe(const DesiredState& desired, bool gesture) {
    if (!known_) {
        settled_ = desired;
        known_ = true;
        return;
    }
    if (gesture || differences(settled_, desired).empty()) return;
    undo_.push_back(settled_);
    if (undo_.size() > kSteps) undo_.erase(undo_.begin());
    redo_.clear();
    settled_ = desired;
}

void History::forget() {
    known_ = false;
    undo_.clear();
    redo_.clear();
}

void History::lights_moved(const std::vector<Light>& before, const std::vector<Light>& now) {
    follow_lights(settled_, before, now);
    for (DesiredState& step : undo_) follow_lights(step, before, now);
    for (DesiredState& step : redo_) follow_lights(step, before, now);
}

void follow_lights(DesiredState& desired, const std::vector<Light>& before, const std::vector<Light>& now) {
    for (size_t i = 0; i < std::min({desired.lights.size(), before.size(), now.size()}); ++i)
        if (same_light(desired.lights[i].values, before[i].values)) desired.lights[i].values = now[i].values;
}

std::string History::undo_name() const {
    return undo_.empty() ? std::string() : difference_name(undo_.back(), settled_);
}

std::string History::redo_name() const {
    return redo_.empty() ? std::string() : difference_name(settled_, redo_.back());
}

void History::undo(DesiredState& desired) {
    observe(desired, false);  // a change that observe() has not seen yet is a step too
    if (undo_.empty()) return;
    redo_.push_back(settled_);
    settled_ = undo_.back();
    undo_.pop_back();
    restore(desired, settled_);
}

void History::redo(DesiredState& desired) {
    observe(desired, false);
    if (redo_.empty()) return;
    undo_.push_back(settled_);
    settled_ = redo_.back();
    redo_.pop_back();
    restore(desired, settled_);
}

}  // namespace clarity::ui
