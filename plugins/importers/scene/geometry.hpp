// geometry.hpp -- checks polygons, and computes the transform of a loaded file.
#pragma once
#include <string>
#include <vector>

#include "document.hpp"

namespace scene_format {

// Largest distance of a corner from the polygon's plane, as a fraction of the polygon's size (the largest side of its box).
inline constexpr double kPlanarTolerance = 1e-4;
// A polygon is degenerate if its area is below this fraction of its squared size.
inline constexpr double kAreaTolerance = 1e-9;

// Returns the reason why these corners (3 floats each, at least 3 corners) do not form a planar polygon, or an empty string if
// they do.
std::string polygon_fault(const std::vector<float>& corners);
bool triangle_is_degenerate(const std::array<float, 9>& corners);

// The transform of a loaded file: first scale, then the rotations in their order, then the translation.
class Placement {
 public:
    void scale(const Vec3& factors) { scale_ = factors; }
    void rotate(const Vec3& unit_axis, float degrees);  // in degrees, counter-clockwise seen from the tip of the axis
    void translate(const Vec3& by) { translate_ = by; }
    std::array<float, 12> world_from_object() const;  // row-major 3x4

 private:
    Vec3 scale_{1, 1, 1}, translate_{0, 0, 0};
    std::array<double, 9> rotation_{1, 0, 0, 0, 1, 0, 0, 0, 1};  // row-major
};

}  // namespace scene_format
