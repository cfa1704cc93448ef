// pose_preparer.hpp -- prepares a scene that is shown in one pose after another: its structure follows the pose where that
// pays, else it is built anew.
#pragma once
#include <memory>

#include "stand/multi_preparer.hpp"

namespace clarity {

class PoseFollower;
struct BuiltPose;
struct PosedFrom;
struct PoseUpdate;

// A scene in a pose, as the caller holds it.
class PosedScene {
 public:
    virtual ~PosedScene() = default;
    virtual bool follows() const = 0;  // whether the structure should follow geometry(); else scene() is at rest
    virtual PosedFrom from() const = 0;
    virtual const Pose& geometry() const = 0;
    virtual const std::shared_ptr<const Scene>& scene() const = 0;  // in its pose
    virtual const std::shared_ptr<const Scene>& rest() const = 0;
    // Adds the vertices that geometry() leaves out at first, to it and to scene(), which becomes another object then: builds,
    // and structures that move on the host, need them.
    virtual void add_vertices() = 0;
};

// Of one side of the window. Used from one thread, each time with the same preparer.
class PosePreparer {
 public:
    PosePreparer();
    ~PosePreparer();
    PosePreparer(PosePreparer&&) noexcept;
    PosePreparer& operator=(PosePreparer&&) noexcept;
    // frame_ms: time of a frame, for the choice between refit and build; 0: not known. Throws as MultiPreparer::prepare() and
    // PoseFollower::refit().
    std::shared_ptr<const MultiPrepared> prepare(MultiPreparer& preparer, PosedScene& shown, const Settings& settings,
                                                 double frame_ms, Progress& progress);
    const PoseUpdate& update() const;
    // Forgets everything.
    void reset();
    // Lets go of all that is on devices. stuck: these cannot release anything any more.
    void leave_devices();
    void lose_devices(bool stuck);

 private:
    void take_build(MultiPreparer& preparer, const PosedScene& shown, const Settings& settings, Progress& progress);
    void built(const MultiPreparer& preparer, const PosedScene& shown, const Settings& settings, const BuiltPose& pose);

    std::unique_ptr<PoseFollower> follower_;
    std::shared_ptr<const MultiPrepared> built_;  // of the last build that the follower follows
};

}  // namespace clarity
