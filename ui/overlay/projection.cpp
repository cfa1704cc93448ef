#include "ui/overlay/projection.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "ui/session/camera_control.hpp"

namespace clarity::ui {
Projection::Projection(const Rect& area, const Camera& camera) : area_(area) {
    const CameraAxes axes = camera_axes(camera);
    eye_ = vec(camera.eye);
    right_ = vec(axes.right);
    up_ = vec(axes.up);
    forward_ = vec(axes.forward);
    half_.y = std::tan(camera.fov_y_rad / 2);
    half_.x = half_.y * area.width / std::max(area.height, 1.0f);
    near_ = std::max(1e-4f * glm::length(vec(camera.target) - eye_), 1e-20f);
}

glm::vec3 Projection::to_camera(const glm::vec3& world) const {
    const glm::vec3 d = world - eye_;
    return {glm::dot(d, right_), glm::dot(d, up_), glm::dot(d, forward_)};
}

glm::vec3 Projection::to_world(const glm::vec3& camera) const {
    return eye_ + right_ * camera.x + up_ * camera.y + forward_ * camera.z;
}

glm::vec2 Projection::to_window(const glm::vec3& camera) const {
    const float scale = area_.height / (2 * half_.y * camera.z);
    return {area_.x + area_.width / 2 + camera.x * scale, area_.y + area_.height / 2 - camera.y * scale};
}

std::optional<glm::vec2> Projection::place(const glm::vec3& world) const {
    const glm::vec3 camera = to_camera(world);
    if (camera.z < near_) return std::nullopt;
    return to_window(camera);
}

glm::vec3 Projection::ray(const glm::vec2& window) const {
    const float x = 2 * (window.x - area_.x) / area_.width - 1, y = 1 - 2 * (window.y - area_.y) / area_.height;
    return glm::normalize(right_ * (x * half_.x) + up_ * (y * half_.y) + forward_);
}

float Projection::unit_at(float depth) const {
    return 2 * half_.y * depth / std::max(area_.height, 1.0f);
}

}  // namespace clarity::ui
