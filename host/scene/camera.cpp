#include "scene/camera.hpp"

#include <cmath>

#include "base/angle.hpp"
#include "scene/usable.hpp"

namespace clarity {

Camera moved_by(Camera camera, const Matrix& world_from_node) {
    camera.eye = to_floats(point(world_from_node, to_vec(camera.node_eye)));
    camera.target = to_floats(point(world_from_node, to_vec(camera.node_target)));
    camera.up = to_floats(direction(world_from_node, to_vec(camera.node_up)));
    return camera;
}

bool make_sound(Camera& camera) {
    if (!are_usable(camera.eye) || !are_usable(camera.target)) return false;
    const Vec forward = to_vec(camera.target) - to_vec(camera.eye), up = to_vec(camera.up), across = cross(forward, up);
    const double distance2 = dot(forward, forward);
    if (!(distance2 > 0)) return false;
    if (!(camera.fov_y_rad > 1e-3f && camera.fov_y_rad < static_cast<float>(kPi) - 1e-3f))
        camera.fov_y_rad = Camera{}.fov_y_rad;
    for (float* size : {&camera.aperture, &camera.focus})
        if (!(*size >= 0 && std::isfinite(*size))) *size = 0;
    if (are_usable(camera.up) && dot(across, across) > 1e-10 * distance2 * dot(up, up)) return true;
    const bool vertical = std::abs(forward[1]) > 0.9 * std::sqrt(distance2);
    camera.up = vertical ? std::array<float, 3>{0, 0, 1} : std::array<float, 3>{0, 1, 0};
    return true;
}

Camera framing_camera(const Scene& scene, float aspect) {
    Camera camera;
    camera.name = "framing";
    const int up_axis = scene.up_axis < 3 ? static_cast<int>(scene.up_axis) : 1;
    Vec up{}, front{};
    up[up_axis] = 1;
    // Programs with Z up look along +Y from the front, all others along -Z.
    if (up_axis == 2) {
        front[1] = -1;
    } else {
        front[2] = 1;
    }
    const Bounds box = scene.bounds();
    Vec center{}, half{};
    for (int i = 0; i < 3 && !box.empty; ++i) {
        center[i] = 0.5 * (double(box.min[i]) + box.max[i]);
        half[i] = 0.5 * (double(box.max[i]) - box.min[i]);
    }
    const double raise = 0.35;  // slope; 19 degrees above the horizon
    const Vec forward = normalized({-front[0] - raise * up[0], -front[1] - raise * up[1], -front[2] - raise * up[2]});
    const Vec right = normalized(cross(forward, up)), above = cross(right, forward);
    const double tan_y = std::tan(0.5 * camera.fov_y_rad);
    const double tan_x = tan_y * (aspect > 0 && std::isfinite(aspect) ? double(aspect) : 1.0);
    // The smallest distance at which all eight corners of the box are inside the frustum.
    double distance = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec offset = {corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1], corner & 4 ? half[2] : -half[2]};
        const double beside = std::max(std::abs(dot(offset, right)) / tan_x, std::abs(dot(offset, above)) / tan_y);
        distance = std::max(distance, beside - dot(offset, forward));
    }
    // The bounds are a point or empty (planes only), so they give no distance: take eye level in a scene in metres.
    const bool pointlike = !(distance > 0);
    distance = pointlike ? 5 : 1.05 * distance;
    for (int i = 0; i < 3; ++i) {
        const double lift = box.empty ? up[i] : 0;
        camera.eye[i] = static_cast<float>(center[i] - distance * forward[i] + lift);
        camera.target[i] = static_cast<float>(center[i] + lift);
        camera.up[i] = static_cast<float>(up[i]);
    }
    return camera;
}

bool same_camera(const Camera& a, const Camera& b) {
    return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_y_rad == b.fov_y_rad && a.aperture == b.aperture &&
           a.focus == b.focus;
}

}  // namespace clarity
