// shapes.hpp -- statements of shapes, which plugins make. Their words and keys come from the host as a table.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "document.hpp"
#include "statement.hpp"

namespace scene_format {

// All kinds of shapes, lights and materials that the sink takes. Throws std::runtime_error if the host is older than their
// tables.
Kinds kinds_of(const rt_scene_sink& sink);
const rt_key& key_of(const rt_primitive_kind& kind, size_t index);
// Reads the numbers of a key of a shape, or of a number or vector of a light or material. Throws StatementError.
std::vector<float> read_values(Statement& s, const rt_key& key);

// Reads the rest of the statement into the document. Throws StatementError.
void read_shape(Statement& s, const rt_primitive_kind& kind, Document& document);

// Checks polygons.

// Largest distance of a corner from the polygon's plane, as a fraction of the polygon's size (the largest side of its box).
inline constexpr double kPlanarTolerance = 1e-4;
// A polygon is degenerate if its area is below this fraction of its squared size.
inline constexpr double kAreaTolerance = 1e-9;

// Returns the reason why these corners (3 floats each, at least 3 corners) do not form a planar polygon, or an empty string if
// they do.
std::string polygon_fault(const std::vector<float>& corners);
bool triangle_is_degenerate(const std::array<float, 9>& corners);

}  // namespace scene_format
