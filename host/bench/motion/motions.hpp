// motions.hpp -- motions that are made by formula, of any scene: every vertex moves.
#pragma once
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"

namespace clarity::bench {

// "wave": vertices go up and down by 3 % of the scene's size. "twist": a turn about the upright axis, by up to a right angle
// from the bottom to the top.
const std::vector<std::string>& motion_names();

// The scene where it is: its instances, cameras and lights.
Pose pose_at_rest(const Scene& scene);
// The vertices of a mesh, to be moved, and their bounds.
struct MeshToMove {
    PosedMesh posed;
    Bounds box;
};
MeshToMove mesh_to_move(const Scene& scene, rt_u32 mesh);

// The scene in a phase of a motion, 0..1. Instances stay where they are.
Pose moved_pose(const Scene& scene, const std::string& motion, double phase);

}  // namespace clarity::bench
