// camera_text.hpp -- a camera as text: ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz. Shorter forms leave out the up vector, or the field
// of view as well.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "base/angle.hpp"
#include "scene/scene.hpp"

namespace clarity {

// Text has the coordinates of files, whose differences from Scene::origin are those of the scene.
std::array<float, 3> scene_point(const std::array<double, 3>& in_file, const std::array<double, 3>& origin);
// Three numbers with all their digits. between: what stands between them.
std::string point_text(const float* in_scene, const std::array<double, 3>& origin, const char* between);

struct CameraNumbers {
    std::array<double, 3> eye{}, target{};  // in the coordinates of files
    std::optional<double> fov_deg;          // double: radians must survive the conversion to degrees and back exactly
    std::optional<std::array<float, 3>> up;
};
// Returns nothing unless the text is 6, 7 or 10 finite numbers with commas between them. Does not check their values.
std::optional<CameraNumbers> read_camera_numbers(const std::string& text);
// All ten numbers, with all their digits.
std::string camera_text(const Camera& camera, const std::array<double, 3>& origin = {});

}  // namespace clarity
