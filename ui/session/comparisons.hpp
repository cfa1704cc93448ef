// comparisons.hpp -- decides what a change of the desired state concerns: preparation, tracing or only the display.
#pragma once
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "scene/camera.hpp"
#include "ui/threads/prepared_scene.hpp"

namespace clarity::ui {

// For plain structs without operator==. Their padding must be zero.
template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_edited_sky(const std::optional<SkyValues>& a, const std::optional<SkyValues>& b);
bool same_view(const View& a, const View& b);

// Whether two requests prepare the same: equal files, kernels, devices, instances and poses, and equal settings except
// for those that apply to the next frame at once.
bool prepares_same(const PrepareRequest& a, const PrepareRequest& b);
// The same, whatever the poses, and whatever the user has done to instances: that moves the scene as a pose does.
bool prepares_same_but_pose(const PrepareRequest& a, const PrepareRequest& b);

bool same_light(const rt_light& a, const rt_light& b);

// Whether two settings trace the same frames, however many samples; and whether they display a traced film in the same way.
bool traces_same(const Settings& a, const Settings& b);
bool displays_same(const Settings& a, const Settings& b);

}  // namespace clarity::ui
