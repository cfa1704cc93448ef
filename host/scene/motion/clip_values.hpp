// clip_values.hpp -- what the channels of a clip say at one time.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "scene/motion/matrix.hpp"
#include "scene/motion/motion.hpp"
#include "scene/motion/node_transform.hpp"
#include "scene/scene.hpp"

namespace clarity {

struct MovingValues {
    std::vector<NodeValues> nodes;             // one for each node of the scene
    std::vector<double> morph_weights;         // one for each morph
    std::vector<float> fovs;                   // one for each camera, radians
    std::vector<std::array<float, 3>> colors;  // one for each light
};
MovingValues values_at_rest(const Scene& scene);

// Which clips play together under a name: of each rig the one of this name, else its first. name: empty for the first of all.
// Throws Error(usage) if no clip has the name.
std::vector<bool> acting_clips(const Motion& motion, const std::string& name);

// Replaces the values that a clip's channels move.
void play(const Scene& scene, const std::string& clip, double time_s, MovingValues& values);

// The value of a channel at a time.

// The number of a channel with one component at a time, in seconds of the clip's clock.
double value_at(const Motion& motion, const Channel& channel, double time_s);
// The unit quaternion of a channel with RT_ALL_COMPONENTS.
Quaternion quaternion_at(const Motion& motion, const Channel& channel, double time_s);

}  // namespace clarity
