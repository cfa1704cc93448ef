// desired_state.hpp -- the state that the user has asked for, as plain values. Any part of the window may change them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "base/members.hpp"
#include "scene/motion/pose_time.hpp"
#include "ui/threads/picture_part.hpp"
#include "view/edit/edit.hpp"
#include "view/settings/settings.hpp"

namespace clarity::ui {

// A light of the scene or of the user. It is traced while `on`.
struct DesiredLight {
    std::string name;
    rt_light values{};
    bool on = true;
};

inline constexpr float kMovingFps = 30;  // the default of DesiredState::moving_fps

// The device and the settings that one picture is traced with.
struct Side {
    std::string device;
    Settings settings;
};

// What the user has changed of a scene's objects.
struct ObjectEdits {
    InstanceEdits instances;  // moved and hidden
    MapEdits maps;            // other textures of materials
    CLARITY_MEMBERS(instances, maps);
};
inline bool same_edits(const ObjectEdits& a, const ObjectEdits& b) {
    return members_of(a) == members_of(b);
}

struct DesiredState : ObjectEdits {
    Side main;
    // A second picture of the same view, for comparison. Size, samples, AOV and tone mapping follow `main`.
    std::optional<Side> other;
    Camera camera;
    std::vector<DesiredLight> lights;
    std::array<float, 3> background{}, ambient{};
    std::optional<SkyValues> sky;           // the edited sky; empty: that of the scene
    std::vector<MaterialValues> materials;  // the edited materials; empty: those of the scene
    PoseTime pose;                    // when the scene is shown; its clip is the chosen one even while the scene is at rest
    CameraPath camera_path;           // the camera is there when the time changes
    std::array<double, 2> loop{};     // the seconds of the clip that are played, again and again
    float speed = 1;                  // of the clip's clock while it plays
    bool continuous = false;          // trace again and again, to measure
    bool equal_time = false;          // the second side gets the seconds of the first, and not its samples
    float resolution_scale = 1;       // factor for the picture's width and height
    std::optional<PicturePart> part;  // that alone is traced
    // Target frame rate while something moves, reached by tracing fewer pixels; 0: always trace all pixels.
    float moving_fps = kMovingFps;
};

// The view of the desired state, with the lights and instances that are switched off in it.
EditedView edited_view(const DesiredState& desired);

}  // namespace clarity::ui
