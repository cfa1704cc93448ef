// camera.hpp -- cameras that a node moves, cameras that cannot be used as they are, and one for scenes that have none.
#pragma once
#include "scene/motion/matrix.hpp"
#include "scene/scene.hpp"

namespace clarity {

// The camera where its node has the given transform.
Camera moved_by(Camera camera, const Matrix& world_from_node);

// Replaces an unusable up vector or field of view. Returns false if the camera has no view direction.
bool make_sound(Camera& camera);

// Whether both give the same view, whatever their names.
bool same_camera(const Camera& a, const Camera& b);

// A camera which shows the whole scene from the front and slightly from above.
Camera framing_camera(const Scene& scene, float aspect);

}  // namespace clarity
