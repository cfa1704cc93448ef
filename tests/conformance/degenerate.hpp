// degenerate.hpp -- a scene of cases that are hard for ray tracers.
#pragma once
#include "support/generated.hpp"

namespace clarity::test {

// Triangles without area (points, needles, two equal corners), every triangle of a box twice, walls in the axes' planes with
// common edges, a floor of 1e6 units and a cluster of triangles of 1e-4. view_of_degenerate() shows all of it.
Scene degenerate_scene();
View view_of_degenerate();

}  // namespace clarity::test
