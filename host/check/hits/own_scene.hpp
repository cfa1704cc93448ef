// own_scene.hpp -- whether a structure's hits are right in a scene and for rays of the user's own.
#pragma once
#include <vector>

#include "check/hits/bench.hpp"

namespace clarity::check {

// The scene has no shapes: only their plugins know where rays meet them.
Check own_scene_check(const BenchInput& input, Scene scene, const std::vector<rt_ray>& rays);

}  // namespace clarity::check
