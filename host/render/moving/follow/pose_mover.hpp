// pose_mover.hpp -- moves a built structure to poses: on the host, or on the devices that trace it.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "render/accel/accel_build.hpp"
#include "render/launch/device_scene.hpp"
#include "render/moving/moved_group.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"

namespace clarity {

// A structure in a pose.
struct MovedStructure {
    std::shared_ptr<const AccelData> accel;  // nullptr: it must be built, for the reason in `why`
    // Its buffers, where they are on devices already.
    std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>> on_devices;
    std::string why;
    double worst_cost_ratio = 1;       // expected cost of a ray by that after the build, of the group that has suffered most
    std::vector<MovedGroup> groups{};  // those that moved
    uint64_t refitted = 0;             // primitives
    double ms = 0;
    // Devices moved it: `accel` is the structure as it was built, whose nodes and leaves are out of date.
    bool by_devices = false;
};

class PoseMover {
 public:
    virtual ~PoseMover() = default;
    // Why the structure can only be built anew; empty: it can follow poses.
    virtual const std::string& cannot() const = 0;
    virtual bool on_devices() const { return false; }
    // Whether move() can build trees, where they are traced; otherwise the caller builds.
    virtual bool can_build() const { return false; }
    // Whether poses may leave out vertices that follow from a deformation.
    virtual bool can_deform() const { return false; }
    // Returns the structure in a pose of its scene. build: trees of what has moved are built anew, instead of refitted. Throws
    // Error(failed) and Cancelled. One call at a time.
    virtual MovedStructure move(const Pose& pose, bool build, Progress& progress) = 0;
};

// On the host: see MovingAccel.
std::unique_ptr<PoseMover> make_host_mover(std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built);

// On devices, each of which has the structure in its memory: see DeviceMotion. Returns after they are done. rest: the scene at
// rest. nullptr: they cannot, for the reason in *why.
std::unique_ptr<PoseMover> make_device_mover(
    std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> built, const std::shared_ptr<const Scene>& rest,
    const std::vector<std::pair<std::shared_ptr<Device>, std::shared_ptr<const DeviceScene>>>& on_devices, std::string* why);

}  // namespace clarity
