// projection.hpp -- converts between world space and window coordinates for a camera. Pure arithmetic.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "scene/scene.hpp"
#include "ui/widgets/rect.hpp"

namespace clarity::ui {

// The view of a camera. Its picture fills a rectangle of the window.
class Projection {
 public:
    Projection(const Rect& area, const Camera& camera);
    const Rect& area() const { return area_; }
    const glm::vec3& eye() const { return eye_; }
    // The smallest depth along the line of sight that place() accepts.
    float near() const { return near_; }

    // Camera space: right, up, and depth along the line of sight.
    glm::vec3 to_camera(const glm::vec3& world) const;
    glm::vec3 to_world(const glm::vec3& camera) const;
    // Window coordinates of a point in camera space. Its depth must be positive.
    glm::vec2 to_window(const glm::vec3& camera) const;
    // Window coordinates of a point of the world; nullopt if it is behind the eye.
    std::optional<glm::vec2> place(const glm::vec3& world) const;
    // The unit direction of the ray through a point of the window.
    glm::vec3 ray(const glm::vec2& window) const;
    // The length in the world of one window unit at this depth.
    float unit_at(float depth) const;
    // The tangents of half the angle of view, horizontally and vertically.
    const glm::vec2& half_size() const { return half_; }

 private:
    Rect area_;
    glm::vec3 eye_, right_, up_, forward_;
    glm::vec2 half_;
    float near_ = 0;
};

}  // namespace clarity::ui
