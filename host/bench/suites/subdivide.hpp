// subdivide.hpp -- a model of any size from one of a few triangles.
#pragma once
#include "scene/scene.hpp"

namespace clarity::bench {

// Each triangle becomes n x n. New points bulge as the vertex normals say (Boubekeur and Alexa 2008, "Phong Tessellation") and
// are then displaced along the normal by a few octaves of waves down to the size of the new triangles, so that a large model is
// rough at every scale and no mere copy in parts of flat ones. Closed meshes stay closed. All instances are flattened into one
// mesh of one material each triangle; spheres, planes and polygons are kept.
Scene subdivide(const Scene& scene, unsigned n);

}  // namespace clarity::bench
