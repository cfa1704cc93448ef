// subdivide.hpp -- splits the triangles of a small model to make a model of any size.
#pragma once
#include "scene/scene.hpp"

namespace clarity::bench {

// Splits each triangle into n x n triangles. New points follow the curvature which the vertex normals give (Boubekeur and Alexa
// 2008, "Phong Tessellation"). They are then displaced along the normal by several octaves of waves, down to the size of the
// new triangles. A large model is thus rough at every scale: flat copies of the old triangles would be easier to trace. Closed
// meshes stay closed. All instances become one mesh with a material per triangle. Spheres, planes and polygons are kept.
Scene subdivide(const Scene& scene, unsigned n);

}  // namespace clarity::bench
