#include "stand/pose_preparer.hpp"

#include <utility>

#include "device/device_loss.hpp"
#include "launch/prepared.hpp"
#include "moving/follow/pose_follower.hpp"
#include "moving/on_host/host_mover.hpp"

namespace clarity {

PosePreparer::PosePreparer() : follower_(std::make_unique<PoseFollower>()) {}
PosePreparer::~PosePreparer() = default;
PosePreparer::PosePreparer(PosePreparer&&) noexcept = default;
PosePreparer& PosePreparer::operator=(PosePreparer&&) noexcept = default;

const PoseUpdate& PosePreparer::update() const {
    return follower_->update();
}

std::shared_ptr<const MultiPrepared> PosePreparer::prepare(MultiPreparer& preparer, PosedScene& shown, const Settings& settings,
                                                           double frame_ms, Progress& progress) {
    const bool follows = shown.follows();
    if (!follows || (follower_->structure() && !preparer.asks_for(*follower_->structure(), settings))) reset();
    if (!follows) return preparer.prepare(shown.scene(), settings, progress);
    const PosedFrom from = shown.from();
    const Pose& pose = shown.geometry();
    const std::shared_ptr<const Scene>& scene = shown.scene();
    if (settings.shutter > 0) follower_->leave_devices();  // blurred pictures move the structure on the host
    take_build(preparer, shown, settings, progress);
    const PoseFollower::Way way = way_of(settings.poses);
    const bool builds_beside = follower_->wants_build_beside(from, pose, way);
    if (follower_->needs_vertices() || builds_beside) shown.add_vertices();
    if (builds_beside) follower_->build_beside(from, scene, pose, preparer.builder(settings));
    MovedStructure moved = follower_->refit(from, scene, pose, way, frame_ms, progress);
    if (moved.accel && moved.on_devices.empty() && built_)
        moved.on_devices = built_->moved_buffers(pose, moved.accel, progress);
    if (!moved.accel) shown.add_vertices();
    const auto prepared = preparer.prepare(scene, settings, progress, moved);
    if (!moved.accel) {
        built_ = prepared;
        built(preparer, shown, settings, {scene, pose, prepared->first()->accel});
    }
    if (settings.poses == "clip" && follower_->wants_choice(from))
        follower_->choose_beside(from, shown.rest(), preparer.builder(settings));
    return prepared;
}

// Goes over to a structure that was built beside the last poses.
void PosePreparer::take_build(MultiPreparer& preparer, const PosedScene& shown, const Settings& settings, Progress& progress) {
    const BuiltPose pose = follower_->take_build(shown.from());
    if (!pose.accel) return;
    built_ = preparer.prepare(pose.scene, settings, progress, pose.accel);
    built(preparer, shown, settings, pose);
}

// The follower goes on from the structure in built_.
void PosePreparer::built(const MultiPreparer& preparer, const PosedScene& shown, const Settings& settings,
                         const BuiltPose& pose) {
    std::unique_ptr<PoseMover> mover;
    if (settings.shutter > 0)
        mover = std::make_unique<HostMover>(pose.scene, built_->first()->accel);
    else
        mover = preparer.mover(pose.scene, shown.rest(), *built_);
    follower_->built(shown.from(), pose.scene, pose.pose, pose.accel, std::move(mover));
}

void PosePreparer::reset() {
    follower_->reset();
    built_.reset();
}

void PosePreparer::leave_devices() {
    follower_->leave_devices();
    built_.reset();
}

void PosePreparer::lose_devices(bool stuck) {
    if (stuck) never_release(std::shared_ptr<PoseFollower>(std::exchange(follower_, std::make_unique<PoseFollower>())));
    reset();
}

}  // namespace clarity
