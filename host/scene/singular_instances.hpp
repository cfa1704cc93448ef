// singular_instances.hpp -- instances whose transform has no inverse, because it scales by 0 along an axis.
#pragma once
#include "scene/scene.hpp"

namespace clarity {

// Kernels need the inverse of an instance's transform. So the mesh of a singular instance is copied with the transform applied,
// and the instance places the copy where it is. Throws Error(import_failed) if the scene cannot hold the copies.
void bake_singular_instances(Scene& scene);

}  // namespace clarity
