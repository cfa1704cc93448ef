// geometry.hpp -- checks polygons.
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

}  // namespace scene_format
