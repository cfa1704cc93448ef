// projection.hpp -- world space to the window's coordinates and back, as a camera sees it. Pure arithmetic.
#pragma once
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>

#include "scene/scene.hpp"
#include "ui/viewport/viewport.hpp"

namespace clarity::ui {

class Projection {
 public:
    Projection(const Rect& area, const Camera& camera);
    const Rect& area() const { return area_; }
    const glm::vec3& eye() const { return eye_; }
    // Nothing nearer than this, along the line of sight, is placed.
    float near() const { return near_; }

    // Right, up, and depth along the line of sight.
    glm::vec3 to_camera(const glm::vec3& world) const;
    glm::vec3 to_world(const glm::vec3& camera) const;
    // Of a point in camera space whose depth is positive.
    glm::vec2 to_window(const glm::vec3& camera) const;
    // nullopt: behind the eye.
    std::optional<glm::vec2> place(const glm::vec3& world) const;
    // Unit direction of the ray through a place of the window.
    glm::vec3 ray(const glm::vec2& window) const;
    // What one unit of the window is worth in the world, at that depth.
    float unit_at(float depth) const;
    // tan of half the angle of view, to the side and upwards.
    const glm::vec2& half_size() const { return half_; }

 private:
    Rect area_;
    glm::vec3 eye_, right_, up_, forward_;
    glm::vec2 half_;
    float near_ = 0;
};

}  // namespace clarity::ui
