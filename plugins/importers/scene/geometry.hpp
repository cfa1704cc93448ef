// geometry.hpp -- checks of polygons, and the transform of a loaded file.
#pragma once
#include <string>
#include <vector>

#include "document.hpp"

namespace scene_format {

// A corner may lie this part of the polygon's size (largest side of its box) off its plane.
inline constexpr double kPlanarTolerance = 1e-4;
// A polygon of less area than this part of its size squared is degenerate.
inline constexpr double kAreaTolerance = 1e-9;

// What keeps these corners (3 floats each, 3 corners or more) from being a planar polygon; empty: nothing.
std::string polygon_fault(const std::vector<float>& corners);
bool triangle_is_degenerate(const std::array<float, 9>& corners);

// Scale, then the rotations in their order, then the translation.
class Placement {
 public:
    void scale(const Vec3& factors) { scale_ = factors; }
    void rotate(const Vec3& unit_axis, float degrees);  // counter-clockwise, seen from the axis' tip
    void translate(const Vec3& by) { translate_ = by; }
    std::array<float, 12> world_from_object() const;  // row-major 3x4

 private:
    Vec3 scale_{1, 1, 1}, translate_{0, 0, 0};
    std::array<double, 9> rotation_{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
};

}  // namespace scene_format
