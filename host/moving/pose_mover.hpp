// pose_mover.hpp -- who moves a built structure to poses: HostMover, or DeviceMover on each of the devices that trace it.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "device/device.hpp"
#include "launch/device_scene.hpp"
#include "rt_plugin.h"
#include "scene/motion/pose.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

// What came of moving a structure to a pose.
struct MovedGroup {
    rt_u32 group = 0;         // 0: the world; the others are one mesh each
    uint64_t primitives = 0;  // of its tree
    // Expected cost (SAH) of a ray by that after the tree's build; of devices: as far as they have told it. 1: as good as then.
    double cost_ratio = 1;
};

// A structure in a pose.
struct MovedStructure {
    std::shared_ptr<const AccelData> accel;  // nullptr: it must be built, for the reason in `why`
    // Its buffers, where they are on devices already.
    std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>> on_devices;
    std::string why;  // "instance `door` is hidden"; empty: nothing must be built
    // Expected cost of a ray (SAH) by that after the build: the greatest of all groups, also of those that did not move. 1: as
    // good as after the build.
    double worst_cost_ratio = 1;
    std::vector<MovedGroup> groups;  // those that moved
    uint64_t refitted = 0;           // primitives
    double ms = 0;                   // time of the call, or of the devices' work if that took longer
    // Devices moved it: `accel` is the structure as it was built, whose nodes and leaves are out of date.
    bool by_devices = false;
};

class PoseMover {
 public:
    virtual ~PoseMover() = default;
    // Why the structure can only be built anew; nothing: it can follow poses.
    virtual const Problem& cannot() const = 0;
    virtual bool on_devices() const { return false; }
    // Whether move() can build trees, where they are traced; otherwise the caller builds.
    virtual bool can_build() const { return false; }
    // Whether poses may leave out vertices that follow from a deformation.
    virtual bool can_deform() const { return false; }
    // Returns the structure in a pose of its scene. build: trees of what has moved are built anew, instead of refitted. Throws
    // Error(failed) and Cancelled. One call at a time.
    virtual MovedStructure move(const Pose& pose, bool build, Progress& progress) = 0;
};

}  // namespace clarity
