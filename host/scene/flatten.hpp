// flatten.hpp -- meshes that an instance's transform makes flat: a scale of 0 along an axis.
#pragma once
#include "scene/scene.hpp"

namespace clarity {

// An instance needs a transform that can be inverted. Where it flattens its mesh, the mesh is copied in flattened form, and the
// instance places the copy. Throws Error(import_failed) if the scene cannot hold the copies.
void bake_flattened_instances(Scene& scene);

}  // namespace clarity
