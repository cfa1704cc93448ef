// camera.cpp -- cameras that a node moves, and cameras that cannot be used as they are.
#include <algorithm>
#include <cmath>

#include "scene/motion/matrix.hpp"

namespace clarity {
namespace {

constexpr float kPi = 3.14159265f;
// Larger coordinates overflow where they are squared.
constexpr float kMostCoordinate = 1e15f;

bool usable(const std::array<float, 3>& v) {
    return std::all_of(v.begin(), v.end(), [](float x) { return std::abs(x) <= kMostCoordinate; });
}
double squared_length(const float* v) {
    return double(v[0]) * v[0] + double(v[1]) * v[1] + double(v[2]) * v[2];
}
}  // namespace

Camera moved_by(Camera camera, const Matrix& world_from_node) {
    camera.eye = to_floats(point(world_from_node, to_vec(camera.node_eye)));
    camera.target = to_floats(point(world_from_node, to_vec(camera.node_target)));
    camera.up = to_floats(direction(world_from_node, to_vec(camera.node_up)));
    return camera;
}

bool make_sound(Camera& camera) {
    if (!usable(camera.eye) || !usable(camera.target)) return false;
    float forward[3];
    for (int i = 0; i < 3; ++i) forward[i] = camera.target[i] - camera.eye[i];
    const double distance2 = squared_length(forward);
    if (!(distance2 > 0)) return false;
    if (!(camera.fov_y_rad > 1e-3f && camera.fov_y_rad < kPi - 1e-3f)) camera.fov_y_rad = Camera{}.fov_y_rad;
    const float* up = camera.up.data();
    const float across[3] = {forward[1] * up[2] - forward[2] * up[1], forward[2] * up[0] - forward[0] * up[2],
                             forward[0] * up[1] - forward[1] * up[0]};
    if (usable(camera.up) && squared_length(across) > 1e-10 * distance2 * squared_length(up)) return true;
    int axis = 1;  // any axis which is not along the view direction
    if (std::abs(forward[1]) > 0.9 * std::sqrt(distance2)) axis = 2;
    camera.up = {};
    camera.up[axis] = 1;
    return true;
}

}  // namespace clarity
