// read_back.hpp -- a structure that devices have moved, as the host sees it: for the display of its bounding volumes.
#pragma once
#include "launch/device_scene.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

// Returns the slots, roots and instances of a structure that was moved on a device, with everything that accel_volumes() needs;
// it has no leaves. built: the structure as it was built. Waits for the copy. Throws cl::Error.
AccelData read_back(const AccelData& built, const DeviceScene& moved);

}  // namespace clarity
