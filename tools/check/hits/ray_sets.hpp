// ray_sets.hpp -- the rays that are sent into the mixed scene, by kind.
#pragma once
#include <string>
#include <vector>

#include "rt_types.h"
#include "structures/accel_build.hpp"
#include "tools/check/scenes.hpp"

namespace clarity::check {

constexpr float kFar = INFINITY;

struct RaySet {
    const char* name;   // of the check: "hits.random"
    const char* tried;  // what these rays are
    std::vector<rt_ray> rays;
    bool strange = false;  // rays that are not numbers: there is no truth, but answers must be sound and neighbours undisturbed
    const char* hint = "";  // what wrong answers to these rays mostly mean
};

// count: rays of a set, roughly; 0: sets without rays, for their names. scene: the mixed scene as builders see it.
std::vector<RaySet> ray_sets(const BuildScene& scene, size_t count, uint64_t seed = 0);

// Rays at the small flat faces of mixed_scene() and large_scene(), from either side.
void add_close_rays(const BuildScene& scene, size_t count, RayMaker& make, std::vector<rt_ray>& rays);

// Rays into regular_scene() and floor_scene().
std::vector<RaySet> regular_ray_sets(const BuildScene& scene, size_t count, uint64_t seed = 0);
std::vector<RaySet> floor_ray_sets(const BuildScene& scene, size_t count, uint64_t seed = 0);
// Into sizes_scene(): a short one at each triangle.
std::vector<RaySet> each_ray_sets(const BuildScene& scene, size_t count, uint64_t seed = 0);
// Into crowd_scene(): some thirty rays, because each tests all primitives.
std::vector<RaySet> crowd_ray_sets(const BuildScene& scene, size_t count, uint64_t seed = 0);
// Into row_scene(): at each of its small triangles, and along it.
std::vector<RaySet> row_ray_sets(const BuildScene& scene, size_t count, uint64_t seed = 0);

}  // namespace clarity::check
