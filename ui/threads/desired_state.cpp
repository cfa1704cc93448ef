#include "ui/threads/desired_state.hpp"

namespace clarity::ui {

EditedView edited_view(const DesiredState& desired) {
    EditedView edited;
    edited.view.camera = desired.camera;
    edited.view.background = desired.background;
    edited.view.ambient = desired.ambient;
    edited.view.sky = desired.sky;
    edited.view.materials = desired.materials;
    for (const DesiredLight& light : desired.lights) {
        edited.view.lights.push_back(light.values);
        edited.lights_on.push_back(light.on);
    }
    edited.instances = desired.instances;
    edited.maps = desired.maps;
    edited.camera_path = desired.camera_path;
    if (desired.pose.time_s && !desired.camera_path.empty()) {
        CameraKey key{0, desired.camera};
        edited.follows_path = key == CameraKey{0, desired.camera_path.at(*desired.pose.time_s)};
    }
    return edited;
}

}  // namespace clarity::ui
