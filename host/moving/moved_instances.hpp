// moved_instances.hpp -- which instances a pose moves, and whether a built structure can follow them.
#pragma once
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "structures/build_scene.hpp"

namespace clarity {

struct MovedInstances {
    std::string why;               // why a build is needed: "instance `door` is hidden"; empty: it is not
    std::vector<rt_u32> numbers;   // of the Scene's instances that move, or that appear or are hidden
    std::vector<Affine> inverses;  // object_from_world of each; of those that are not visible, anything
};

// "instance `door`", or by its number if it has no name.
std::string name_of(const Instance& instance, size_t number);

// now: where the instances of `scene` are. build: the scene as its structure was built. moved: receives the result; its memory
// is used again.
void find_moved_instances(const Scene& scene, const BuildScene& build, const std::vector<PosedInstance>& now, const Pose& pose,
                          MovedInstances& moved);

// Whether vertices of a mesh that the structure holds moved into the world's space would move. scene: as it was built.
bool moves_flattened_mesh(const Pose& pose, const Scene& scene, const BuildScene& build);

// Nothing, or why the pose's vertices are not those of the scene's meshes.
Problem wrong_vertices(const Scene& scene, const Pose& pose);

}  // namespace clarity
