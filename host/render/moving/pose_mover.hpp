// pose_mover.hpp -- who moves a built structure to poses: HostMover, or DeviceMover on each of the devices that trace it.
#pragma once
#include "base/problem.hpp"
#include "base/progress.hpp"
#include "render/moving/moved_structure.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {

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
