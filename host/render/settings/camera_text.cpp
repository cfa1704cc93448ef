#include "render/settings/camera_text.hpp"

#include "base/numbers.hpp"

namespace clarity {

std::optional<CameraNumbers> read_camera_numbers(const std::string& text) {
    const std::vector<float> n = read_numbers<float>(text);
    if (n.size() != 6 && n.size() != 7 && n.size() != 10) return {};
    CameraNumbers camera;
    camera.eye = {n[0], n[1], n[2]};
    camera.target = {n[3], n[4], n[5]};
    if (n.size() >= 7) camera.fov_deg = read_numbers<double>(text)[6];
    if (n.size() == 10) camera.up = {n[7], n[8], n[9]};
    return camera;
}

std::string camera_text(const Camera& camera) {
    return numbers_text(camera.eye.data(), 3) + "," + numbers_text(camera.target.data(), 3) + "," +
           exact_text(camera.fov_y_rad / kRadPerDegree) + "," + numbers_text(camera.up.data(), 3);
}

}  // namespace clarity
