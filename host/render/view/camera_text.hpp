// camera_text.hpp -- a camera as text: ex,ey,ez,tx,ty,tz,fov_deg,ux,uy,uz[,aperture,focus]. Shorter forms leave out the up
// vector, or the field of view as well.
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
    float aperture = 0, focus = 0;  // of the lens
};
// Returns nothing unless the text is 6, 7, 10 or 12 finite numbers with commas between them. Does not check their values.
std::optional<CameraNumbers> read_camera_numbers(const std::string& text);
// All numbers, with all their digits; those of the lens if there is one.
std::string camera_text(const Camera& camera, const std::array<double, 3>& origin = {});
// "  aperture .02  focus 7" for a text scene, or an empty text for a pinhole.
std::string lens_words(const Camera& camera);

}  // namespace clarity
