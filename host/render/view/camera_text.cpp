#include "render/view/camera_text.hpp"

#include <algorithm>

#include "base/numbers.hpp"

namespace clarity {
namespace {

bool has_lens(const Camera& camera) {
    return camera.aperture != 0 || camera.focus != 0;
}

}  // namespace

std::array<float, 3> scene_point(const std::array<double, 3>& in_file, const std::array<double, 3>& origin) {
    std::array<float, 3> point{};
    for (int k = 0; k < 3; ++k) point[k] = static_cast<float>(in_file[k] - origin[k]);
    return point;
}

std::string point_text(const float* in_scene, const std::array<double, 3>& origin, const char* between) {
    std::string text;
    for (int k = 0; k < 3; ++k)
        text += (k ? between : "") + (origin[k] == 0 ? exact_text(in_scene[k]) : exact_text(double(in_scene[k]) + origin[k]));
    return text;
}

std::optional<CameraNumbers> read_camera_numbers(const std::string& text) {
    const std::vector<float> n = read_numbers<float>(text);
    if (n.size() != 6 && n.size() != 7 && n.size() != 10 && n.size() != 12) return {};
    CameraNumbers camera;
    const std::vector<double> exact = read_numbers<double>(text);
    std::copy_n(exact.begin(), 3, camera.eye.begin());
    std::copy_n(exact.begin() + 3, 3, camera.target.begin());
    if (n.size() >= 7) camera.fov_deg = exact[6];
    if (n.size() >= 10) camera.up = {n[7], n[8], n[9]};
    if (n.size() == 12) camera.aperture = n[10], camera.focus = n[11];
    if (camera.aperture < 0 || camera.focus < 0) return {};
    return camera;
}

std::string camera_text(const Camera& camera, const std::array<double, 3>& origin) {
    return point_text(camera.eye.data(), origin, ",") + "," + point_text(camera.target.data(), origin, ",") + "," +
           exact_text(camera.fov_y_rad / kRadPerDegree) + "," + numbers_text(camera.up.data(), 3) +
           (has_lens(camera) ? "," + exact_text(camera.aperture) + "," + exact_text(camera.focus) : "");
}

std::string lens_words(const Camera& camera) {
    return has_lens(camera) ? "  aperture " + exact_text(camera.aperture) + "  focus " + exact_text(camera.focus) : "";
}

}  // namespace clarity
