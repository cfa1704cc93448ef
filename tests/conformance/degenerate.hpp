// degenerate.hpp -- a scene of what breaks ray tracers.
#pragma once
#include "support/generated.hpp"

namespace clarity::test {

// Zero-area triangles (points, needles, two equal corners), every triangle of a box twice, walls in the axes' planes that share
// edges, a floor of 1e6 units and a cluster of triangles of 1e-4. Looks best from view_of_degenerate().
Scene degenerate_scene();
View view_of_degenerate();

}  // namespace clarity::test
