// pose_follower.hpp -- the structure of a scene that is shown in one pose after another: refitted, or built anew where that
// pays.
//
//   MovedStructure moved = follower.refit(from, posed, pose, way, trace_ms, progress);
//   if (!moved.accel) { auto accel = build(posed); follower.built(from, posed, pose, accel, std::make_unique<HostMover>(posed,
//   accel)); }
#pragma once
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "base/problem.hpp"
#include "base/progress.hpp"
#include "moving/follow/background_build.hpp"
#include "moving/follow/refit_policy.hpp"
#include "moving/pose_mover.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

// A tree that follows poses: that of a mesh, or of the world.
struct TreeUpdate {
    rt_u32 mesh = RT_NONE;          // of the scene; RT_NONE: the world
    std::string name;               // the mesh's
    uint64_t primitives = 0;        // of the tree
    std::string what;               // "refitted", "built", "still"
    std::deque<float> cost_ratios;  // as in PoseUpdate
};

// How a structure came to its pose.
struct PoseUpdate {
    bool followed = false;  // false: the scene is at rest, or nothing was done for a pose
    bool refitted = false;  // false: built anew
    bool building = false;  // a build for one of the last poses runs beside
    std::string why;        // "rays cost 1.12 times what they cost after the last build"; "instance `door` is hidden"
    double ms = 0;
    uint64_t primitives = 0;        // that were refitted
    std::deque<float> cost_ratios;  // of the last poses, the newest last; 1: as good as after its build
    std::vector<TreeUpdate> trees;  // those that have moved, the first 64 of them
};

// What the poses belong to: poses of another scene or clip need a build.
struct PosedFrom {
    std::shared_ptr<const Scene> scene;  // as imported
    std::string clip;
    bool at_rest = false;         // no clip plays
    std::vector<rt_u32> apart{};  // instances that a user moves, ascending
    bool operator==(const PosedFrom& b) const {
        return scene == b.scene && clip == b.clip && at_rest == b.at_rest && apart == b.apart;
    }
};

// Used on one thread at a time.
class PoseFollower {
 public:
    enum class Way { automatic, refit, build };

    // Returns the structure of `posed`, which is the scene in `pose`: refitted, or built by devices. Without `accel`: the
    // caller must build it, for the reason in update().why. trace_ms: time of a frame; 0: not known. Throws as
    // PoseMover::move().
    MovedStructure refit(const PosedFrom& from, const std::shared_ptr<const Scene>& posed, const Pose& pose, Way way,
                         double trace_ms, Progress& progress);
    // Says that this structure was built for the pose. mover: moves it to other poses.
    void built(const PosedFrom& from, std::shared_ptr<const Scene> posed, const Pose& pose,
               std::shared_ptr<const AccelData> accel, std::unique_ptr<PoseMover> mover);
    // Builds beside refits, so that a motion does not stop for them. A build that should be made is started with
    // build_beside(); the structure is refitted meanwhile. A build that is done is taken, prepared, and passed to built().
    bool wants_build_beside(const PosedFrom& from, const Pose& pose, Way way) const;
    // scene: with all vertices of the pose.
    void build_beside(const PosedFrom& from, std::shared_ptr<const Scene> scene, const Pose& pose, const AccelBuilder& build);
    // Whether the tree of a clip should be chosen now among those of several poses; once for each clip. choose_beside() does
    // that as build_beside(). rest: the scene at rest.
    bool wants_choice(const PosedFrom& from) const;
    void choose_beside(const PosedFrom& from, std::shared_ptr<const Scene> rest, const AccelBuilder& build);
    // Without `accel`: no build is done, or it is of another scene or clip. Throws what the build threw.
    BuiltPose take_build(const PosedFrom& from);

    // Forgets everything: the scene is at rest, or other settings ask for another structure.
    void reset() { *this = PoseFollower(); }
    // Forgets everything if it holds buffers on devices: these will be closed.
    void leave_devices() {
        if (mover_ && mover_->on_devices()) reset();
    }

    // Whether refit() needs poses with all vertices. The others are made on devices.
    bool needs_vertices() const { return !mover_ || !mover_->can_deform(); }
    const AccelData* structure() const { return now_.accel.get(); }  // the newest; nullptr: none
    const PoseUpdate& update() const { return update_; }

 private:
    Problem why_not(const PosedFrom& from, const Pose& pose) const;
    std::string why_build(Way way) const;
    void note_trees(const MovedStructure& moved, const Scene& scene, bool built);

    PosedFrom from_;
    std::unique_ptr<PoseMover> mover_;
    std::vector<rt_u32> deformed_;  // the meshes that poses deform
    std::shared_ptr<const Scene> posed_;
    MovedStructure now_;  // of posed_
    struct Beside {
        PosedFrom from;
        BackgroundBuild build;
    };
    std::unique_ptr<Beside> beside_;  // nullptr: no build runs
    PosedFrom chosen_for_;            // the clip whose tree was chosen last
    RefitPolicy policy_;
    double refit_ms_ = 0;
    PoseUpdate update_;
};

// "auto", "refit", "build": values of the setting `poses`.
PoseFollower::Way way_of(const std::string& poses);

}  // namespace clarity
