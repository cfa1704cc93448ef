// line_list.hpp -- shapes in the world as lines: boxes, spheres, circles, arrows. What gl_lines draws. Pure arithmetic.
#pragma once
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

namespace clarity::ui {

struct Line {
    glm::vec3 a{}, b{};
    uint32_t color = 0;  // RGBA8, R in the low byte, as IM_COL32 packs it
    float width = 1;     // units of the window
};

class LineList {
 public:
    void clear() { lines_.clear(); }
    void reserve(size_t lines) { lines_.reserve(lines); }
    bool empty() const { return lines_.empty(); }
    size_t size() const { return lines_.size(); }
    const std::vector<Line>& lines() const { return lines_; }

    bool operator==(const LineList& other) const;
    void line(const glm::vec3& a, const glm::vec3& b, uint32_t color, float width) { lines_.push_back({a, b, color, width}); }
    // Corners whose numbers differ in one bit share an edge.
    void box(const std::array<std::array<float, 3>, 8>& corners, uint32_t color, float width);
    // Points center + a cos + b sin.
    void circle(const glm::vec3& center, const glm::vec3& a, const glm::vec3& b, int segments, uint32_t color, float width);
    // The circle of points that `eye` sees as the sphere's outline; nothing from within.
    void outline(const glm::vec3& center, float radius, const glm::vec3& eye, int segments, uint32_t color, float width);
    // Three great circles along the axes.
    void great_circles(const glm::vec3& center, float radius, int segments, uint32_t color, float width);
    // Four strokes back from `tip`, which lies in `direction` (unit).
    void arrow_head(const glm::vec3& tip, const glm::vec3& direction, float length, uint32_t color, float width);
    // A small octahedron.
    void dot(const glm::vec3& center, float radius, uint32_t color, float width);

 private:
    std::vector<Line> lines_;
};

// Two axes across a unit vector.
std::array<glm::vec3, 2> axes_across(const glm::vec3& unit);
// The color with its opacity multiplied.
uint32_t with_opacity(uint32_t color, float factor);

}  // namespace clarity::ui
