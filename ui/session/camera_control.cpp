#include "ui/session/camera_control.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "scene/light_kinds.hpp"

namespace clarity::ui {
namespace {

Vec3 arr(const glm::vec3& a) {
    return {a.x, a.y, a.z};
}

glm::vec3 unit_or(const glm::vec3& a, const glm::vec3& otherwise) {
    const float length = glm::length(a);
    return length > 1e-20f && std::isfinite(length) ? a / length : otherwise;
}

// Returns a unit vector perpendicular to `a`.
glm::vec3 across(const glm::vec3& a) {
    const glm::vec3 other = std::abs(a.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    return glm::normalize(glm::cross(a, other));
}

// Rotates a about the unit axis k (Rodrigues' formula).
glm::vec3 rotate(const glm::vec3& a, const glm::vec3& k, float rad) {
    const float c = std::cos(rad), s = std::sin(rad);
    return a * c + glm::cross(k, a) * s + k * (glm::dot(k, a) * (1 - c));
}

struct Axes {
    glm::vec3 right, up, forward, vertical;
};

Axes axes_of(const Camera& camera) {
    Axes axes;
    axes.vertical = unit_or(vec(camera.up), {0, 1, 0});
    axes.forward = unit_or(vec(camera.target) - vec(camera.eye), {0, 0, -1});
    axes.right = unit_or(glm::cross(axes.forward, axes.vertical), across(axes.forward));
    axes.up = glm::cross(axes.right, axes.forward);
    return axes;
}

glm::vec3 ground_offset(const Camera& camera, const Step& step) {
    const Axes axes = axes_of(camera);
    const glm::vec3 ahead = unit_or(glm::cross(axes.vertical, axes.right), axes.up);
    return axes.right * step.right + axes.vertical * step.up + ahead * step.forward;
}

void shift(Camera& camera, const glm::vec3& offset) {
    camera.eye = arr(vec(camera.eye) + offset);
    camera.target = arr(vec(camera.target) + offset);
}

// The viewing direction after yaw about the vertical and pitch. It stays two degrees away from the poles.
glm::vec3 turned(const Axes& axes, float yaw_rad, float pitch_rad) {
    constexpr float limit = 1.5359f;
    const float height = std::asin(glm::clamp(glm::dot(axes.forward, axes.vertical), -1.0f, 1.0f));
    const float pitch = glm::clamp(height + pitch_rad, -limit, limit) - height;
    return rotate(rotate(axes.forward, axes.right, pitch), axes.vertical, yaw_rad);
}

}  // namespace

CameraAxes camera_axes(const Camera& camera) {
    const Axes axes = axes_of(camera);
    return {arr(axes.right), arr(axes.up), arr(axes.forward)};
}

void move_camera(Camera& camera, const Step& step) {
    shift(camera, ground_offset(camera, step));
}

void fly_camera(Camera& camera, const Step& step) {
    const Axes axes = axes_of(camera);
    shift(camera, axes.right * step.right + axes.vertical * step.up + axes.forward * step.forward);
}

void turn_camera(Camera& camera, float yaw_rad, float pitch_rad) {
    const glm::vec3 eye = vec(camera.eye);
    const float distance = glm::length(vec(camera.target) - eye);
    camera.target = arr(eye + turned(axes_of(camera), yaw_rad, pitch_rad) * distance);
}

void orbit_camera(Camera& camera, float yaw_rad, float pitch_rad) {
    const glm::vec3 target = vec(camera.target);
    const float distance = glm::length(target - vec(camera.eye));
    camera.eye = arr(target - turned(axes_of(camera), yaw_rad, pitch_rad) * distance);
}

void pan_camera(Camera& camera, float right, float up) {
    const Axes axes = axes_of(camera);
    shift(camera, axes.right * right + axes.up * up);
}

void zoom_camera(Camera& camera, float factor) {
    const glm::vec3 target = vec(camera.target);
    camera.eye = arr(target + (vec(camera.eye) - target) * factor);
}

void frame_bounds(Camera& camera, const Bounds& bounds, float aspect) {
    if (bounds.empty) return;
    const float half_y = camera.fov_y_rad / 2, half_x = std::atan(std::tan(half_y) * aspect);
    const float radius = std::max(bounds.diagonal() / 2, 1e-6f);
    const float distance = 1.05f * radius / std::sin(std::min(half_x, half_y));
    const Axes axes = axes_of(camera);
    const glm::vec3 middle = (vec(bounds.min) + vec(bounds.max)) * 0.5f;
    camera.target = arr(middle);
    camera.eye = arr(middle - axes.forward * distance);
}

void move_light(rt_light& light, const Camera& camera, const Step& step, float size) {
    glm::vec3 place(light.position[0], light.position[1], light.position[2]);
    const glm::vec3 offset = ground_offset(camera, step);
    if (!light_kind_of(light).has_place)
        place = unit_or(place + offset / std::max(size, 1e-20f), place);
    else
        place += offset;
    for (int i = 0; i < 3; ++i) light.position[i] = place[i];
    make_sound(light, true);
}

}  // namespace clarity::ui
