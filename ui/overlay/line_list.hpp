// line_list.hpp -- world-space shapes as lines (boxes, spheres, circles, arrows), for gl_lines to draw. Pure arithmetic.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace clarity::ui {

struct Line {
    glm::vec3 a{}, b{};
    uint32_t color = 0;  // RGBA8, R in the low byte, like IM_COL32
    float width = 1;     // in units of the window
};

// A list of lines in world space.
class LineList {
 public:
    void clear() { lines_.clear(); }
    void reserve(size_t lines) { lines_.reserve(lines); }
    bool empty() const { return lines_.empty(); }
    size_t size() const { return lines_.size(); }
    const std::vector<Line>& lines() const { return lines_; }

    bool operator==(const LineList& other) const;
    void line(const glm::vec3& a, const glm::vec3& b, uint32_t color, float width) { lines_.push_back({a, b, color, width}); }
    // Two corners share an edge if their indices differ in one bit.
    void box(const std::array<std::array<float, 3>, 8>& corners, uint32_t color, float width);
    // The points center + a cos(t) + b sin(t).
    void circle(const glm::vec3& center, const glm::vec3& a, const glm::vec3& b, int segments, uint32_t color, float width);
    // The circle which is the outline of the sphere as seen from `eye`; nothing if the eye is inside.
    void outline(const glm::vec3& center, float radius, const glm::vec3& eye, int segments, uint32_t color, float width);
    // Three great circles, one about each axis.
    void great_circles(const glm::vec3& center, float radius, int segments, uint32_t color, float width);
    // Four strokes which end in `tip`. direction: unit vector that the arrow points to.
    void arrow_head(const glm::vec3& tip, const glm::vec3& direction, float length, uint32_t color, float width);
    // A small octahedron.
    void dot(const glm::vec3& center, float radius, uint32_t color, float width);

 private:
    std::vector<Line> lines_;
};

// Two axes perpendicular to a unit vector and to each other.
std::array<glm::vec3, 2> axes_across(const glm::vec3& unit);
// The colour with its opacity multiplied by `factor`.
uint32_t with_opacity(uint32_t color, float factor);

}  // namespace clarity::ui
