#include "ui/overlay/line_list.hpp"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "base/angle.hpp"
#include "ui/session/camera_control.hpp"

namespace clarity::ui {

std::array<glm::vec3, 2> axes_across(const glm::vec3& unit) {
    const glm::vec3 other = std::abs(unit.x) < 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 side = glm::normalize(glm::cross(unit, other));
    return {side, glm::cross(unit, side)};
}

uint32_t with_opacity(uint32_t color, float factor) {
    const float alpha = static_cast<float>(color >> 24) * factor;
    return (color & 0xFFFFFFu) | static_cast<uint32_t>(glm::clamp(alpha + 0.5f, 0.0f, 255.0f)) << 24;
}

bool LineList::operator==(const LineList& other) const {
    const auto same = [](const Line& a, const Line& b) {
        return a.a == b.a && a.b == b.b && a.color == b.color && a.width == b.width;
    };
    return std::equal(lines_.begin(), lines_.end(), other.lines_.begin(), other.lines_.end(), same);
}

void LineList::box(const std::array<std::array<float, 3>, 8>& corners, uint32_t color, float width) {
    for (unsigned corner = 0; corner < 8; ++corner)
        for (unsigned bit = 1; bit < 8; bit <<= 1)
            if (!(corner & bit)) line(vec(corners[corner]), vec(corners[corner | bit]), color, width);
}

void LineList::circle(const glm::vec3& center, const glm::vec3& a, const glm::vec3& b, int segments, uint32_t color,
                      float width) {
    // Each point is the last one rotated by a constant angle: two products instead of a sine and a cosine.
    const float step = static_cast<float>(kTurn) / static_cast<float>(segments), turn_c = std::cos(step),
                turn_s = std::sin(step);
    float c = 1, s = 0;
    glm::vec3 last = center + a;
    for (int i = 1; i <= segments; ++i) {
        const float next_c = c * turn_c - s * turn_s;
        s = c * turn_s + s * turn_c;
        c = next_c;
        const glm::vec3 next = i == segments ? center + a : center + a * c + b * s;
        line(last, next, color, width);
        last = next;
    }
}

void LineList::outline(const glm::vec3& center, float radius, const glm::vec3& eye, int segments, uint32_t color, float width) {
    const glm::vec3 to_eye = eye - center;
    const float distance = glm::length(to_eye);
    if (!(distance > radius * 1.001f)) return;
    // The tangent planes through the eye touch the sphere in a circle. It is nearer to the eye than the centre by r^2 / d, and
    // its radius is r sqrt(1 - (r/d)^2).
    const glm::vec3 axis = to_eye / distance;
    const auto [side, other] = axes_across(axis);
    const float sine = radius / distance, across = radius * std::sqrt(1 - sine * sine);
    circle(center + axis * (radius * sine), side * across, other * across, segments, color, width);
}

void LineList::great_circles(const glm::vec3& center, float radius, int segments, uint32_t color, float width) {
    const glm::vec3 x(radius, 0, 0), y(0, radius, 0), z(0, 0, radius);
    circle(center, x, y, segments, color, width);
    circle(center, y, z, segments, color, width);
    circle(center, z, x, segments, color, width);
}

void LineList::arrow_head(const glm::vec3& tip, const glm::vec3& direction, float length, uint32_t color, float width) {
    const auto [side, other] = axes_across(direction);
    const glm::vec3 foot = tip - direction * length;
    for (const glm::vec3& away : {side, -side, other, -other}) line(tip, foot + away * (length * 0.4f), color, width);
}

void LineList::dot(const glm::vec3& center, float radius, uint32_t color, float width) {
    glm::vec3 corners[6];
    for (int i = 0; i < 6; ++i) {
        corners[i] = center;
        corners[i][i / 2] += i % 2 ? radius : -radius;
    }
    for (int i = 0; i < 6; ++i)
        for (int k = i + 1; k < 6; ++k)
            if (i / 2 != k / 2) line(corners[i], corners[k], color, width);
}

}  // namespace clarity::ui
