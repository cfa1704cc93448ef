// reference.hpp -- shapes in double precision, found by walking along rays: nothing of it is shared with the plugins.
#pragma once
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "scene/vec.hpp"
#include "support/generated.hpp"

namespace clarity::test {

// A surface as the points where `side` changes its sign, as far as they are `valid`.
struct Sheet {
    std::function<double(const Vec&)> side;
    std::function<bool(const Vec&)> valid;
};
// The same surface with parameters from 0 to 1, for meshes.
using Face = std::function<Vec(double u, double v)>;

struct ShapeCase {
    std::string name, statement;
    double reach;  // it lies within this distance of the origin
    std::vector<Sheet> sheets;
    std::vector<Face> faces;
};
const std::vector<ShapeCase>& shape_cases();

// A case that a text scene loads with a transform.
struct PlacedShape {
    const ShapeCase* shape;
    std::string placement;               // keys of `load`
    std::array<double, 12> world, back;  // world from shape, and back
};
// All cases side by side, turned and scaled, and a few of them several times.
const std::vector<PlacedShape>& placed_shapes();
Vec transformed(const std::array<double, 12>& m, const Vec& p);

// Distance of the nearest hit of all placed shapes that is not nearer than t_min; INFINITY: none.
double nearest_hit(const Vec& origin, const Vec& direction, double t_min);

// The placed shapes as triangles.
ScenePtr fine_mesh();
// The placed shapes as shapes. They are imported from files.
ScenePtr imported_shapes();

}  // namespace clarity::test
