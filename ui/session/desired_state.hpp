// desired_state.hpp -- what a user wishes to see: plain values, which the window's parts change as they like.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "render/settings/edit.hpp"
#include "render/settings/settings.hpp"

namespace clarity::ui {

struct DesiredLight {
    std::string name;
    rt_light values{};
    bool on = true;
};

// How a picture is traced, and on what.
struct Side {
    std::string device;
    Settings settings;
};

struct DesiredState {
    Side main;
    // A second picture of the same view to compare with. Size, samples, what is shown and tone mapping follow `main`.
    std::optional<Side> other;
    Camera camera;
    std::vector<DesiredLight> lights;
    std::array<float, 3> background{}, ambient{};
    std::vector<rt_material> materials;  // edited ones; empty: as the scene has them
    std::vector<rt_u32> hidden;          // instances, ascending
    bool continuous = false;             // trace on and on, for measuring
    float resolution_scale = 1;          // of the picture's size, each way
    float moving_fps = 30;               // frames a second while something moves, at the cost of pixels; 0: always all of them
};

EditedView edited_view(const DesiredState& desired);

}  // namespace clarity::ui
