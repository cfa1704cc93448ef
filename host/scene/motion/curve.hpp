// curve.hpp -- the value of a channel at a time.
#pragma once
#include "scene/motion/matrix.hpp"
#include "scene/motion/motion.hpp"

namespace clarity {

// The number of a channel with one component at a time, in seconds of the clip's clock.
double value_at(const Motion& motion, const Channel& channel, double time_s);
// The unit quaternion of a channel with RT_ALL_COMPONENTS.
Quaternion quaternion_at(const Motion& motion, const Channel& channel, double time_s);

}  // namespace clarity
