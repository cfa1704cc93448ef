// animations.hpp -- animations of 200 frames that are made by formula, each of another kind.
#pragma once
#include <string>
#include <vector>

#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"

namespace clarity::bench {

inline constexpr unsigned kAnimationFrames = 200;

// "walk": the lower half of the model swings like two legs, the upper half like two arms; a step takes 25 frames. "twist": a
// turn about the upright axis, to and fro in 100 frames. "explosion": each triangle flies its own way. "crowd": 400 copies of
// the model, each on a circle of its own, as instances.
const std::vector<std::string>& animation_names();
// The first clip of the file, again and again.
inline constexpr const char* kOwnClip = "clip";

// The scene that the animation moves: a copy with single triangles, or with the copies of a crowd.
Scene staged(const Scene& scene, const std::string& animation);
// A staged scene in a frame. Throws Error(usage) for the clip of a scene that has none.
Pose animated_pose(const Scene& staged, const std::string& animation, unsigned frame);

// Motions that are made by formula, of any scene: every vertex moves.

// "wave": vertices go up and down by 3 % of the scene's size. "twist": a turn about the upright axis, by up to a right angle
// from the bottom to the top.
const std::vector<std::string>& motion_names();

// The vertices of a mesh, to be moved, and their bounds.
struct MeshToMove {
    PosedMesh posed;
    Bounds box;
};
MeshToMove mesh_to_move(const Scene& scene, rt_u32 mesh);

// The scene in a phase of a motion, 0..1. Instances stay where they are.
Pose moved_pose(const Scene& scene, const std::string& motion, double phase);

}  // namespace clarity::bench
