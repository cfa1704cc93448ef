// first_tree.hpp -- chooses the tree that is refitted through a clip among those of several of its poses.
//
// A tree suits the pose that it was built in. Refitted to others, one of the middle of a motion often serves better than that
// of its beginning (Wald, Boulos, Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies").
#pragma once
#include <memory>
#include <string>

#include "base/progress.hpp"
#include "render/moving/follow/background_build.hpp"
#include "scene/scene.hpp"

namespace clarity {

// Builds a structure in each of five poses, evenly over the clip, refits each to the other four, and returns that whose
// expected costs of a ray (SAH) have the least sum. Files of sequences are not read: their meshes stay at rest. rest: the scene
// at rest. Takes as long as five builds and twenty refits, and the memory of two structures and their refits. Throws what
// `build` throws, Error(failed) if the structure cannot be refitted, and Cancelled.
BuiltPose choose_first_tree(const Scene& rest, const std::string& clip, const AccelBuilder& build, Progress& progress);

}  // namespace clarity
