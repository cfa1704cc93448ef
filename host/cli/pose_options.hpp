// pose_options.hpp -- at which time of which clip a command shows a scene.
#pragma once
#include <optional>
#include <string>

#include "scene/motion/pose.hpp"

namespace clarity {

struct PoseOptions {
    std::optional<double> time_s;  // on the clip's own clock; empty: the clip's begin if one is named, else the scene at rest
    std::string clip;              // empty: the first one
};
// Throws Error(usage) if the time is no number.
void check_pose(const PoseOptions& options);

// Whether a scene looks different at other times, or in the pose of its bones.
bool moves(const Scene& scene);

// The scene as the options ask. read: for sequences of files. Warns if it does not move. Throws Error(usage) if it has no such
// clip.
Scene at_pose(Scene scene, const PoseOptions& options, const FrameVertices& read);

// When a frame is shown, in seconds: frame n at n / fps. fps 0: the clip's own, or 24 if the file does not say.
double time_of_frame(const Scene& scene, const std::string& clip, double fps, int number);

}  // namespace clarity
