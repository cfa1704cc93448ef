// pose_options.hpp -- at which time of which clip a command shows a scene.
#pragma once
#include <string>

#include "scene/motion/pose_time.hpp"

namespace clarity {

// The options --time and --clip. A clip alone stands for its begin. The clip may be a name or a number.
using PoseOptions = PoseTime;
// Throws Error(usage) if the time is no number.
void check_pose(const PoseOptions& options);

// Whether a scene looks different at other times, or in the pose of its bones.
bool moves(const Scene& scene);

// The scene as the options ask. read: for sequences of files. Warns if it does not move. Throws Error(usage) if it has no such
// clip.
Scene at_pose(Scene scene, const PoseOptions& options, const FrameVertices& read);

}  // namespace clarity
