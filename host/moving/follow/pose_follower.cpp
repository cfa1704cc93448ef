#include "moving/follow/pose_follower.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "moving/follow/background_build.hpp"
#include "moving/on_host/host_mover.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"

namespace clarity {
namespace {

// Chooses the tree that is refitted through a clip among those of several of its poses.
//
// A tree suits the pose that it was built in. Refitted to others, one of the middle of a motion often serves better than that
// of its beginning (Wald, Boulos, Shirley 2007, "Ray Tracing Deformable Scenes Using Dynamic Bounding Volume Hierarchies").

constexpr int kCandidates = 5;

std::vector<Pose> poses_of(const Scene& rest, const std::string& clip) {
    const std::vector<ClipInfo> all = clips(rest);
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const ClipInfo& info) { return clip.empty() || info.name == clip; });
    if (found == all.end()) throw Error(Exit::usage, "the scene has no clip `" + clip + "`");
    std::vector<Pose> poses;
    for (int k = 0; k < kCandidates; ++k)
        poses.push_back(evaluate(rest, clip, found->begin_s + (k + 0.5) / kCandidates * (found->end_s - found->begin_s)));
    return poses;
}

// The sum of expected costs in all poses. built: in the first of them.
double cost_in(const std::vector<Pose>& poses, const std::shared_ptr<const Scene>& scene,
               const std::shared_ptr<const AccelData>& built, Progress& progress) {
    HostMover moving(scene, built);
    if (moving.cannot()) throw Error(Exit::failed, moving.cannot().text());
    double sum = 0;
    for (const Pose& pose : poses) {
        const MovedStructure moved = moving.move(pose, progress);
        if (!moved.accel) return INFINITY;  // this tree must be built anew there
        sum += moved.accel->stat("sah_cost");
    }
    return sum;
}

// Builds a structure in each of five poses, evenly over the clip, refits each to the other four, and returns the one
// with the least sum of expected costs of a ray (SAH). Files of sequences are not read: their meshes stay at rest. rest: the
// scene at rest. Takes as long as five builds and twenty refits, and the memory of two structures and their refits. Throws what
// `build` throws, Error(failed) if the structure cannot be refitted, and Cancelled.
BuiltPose choose_first_tree(const Scene& rest, const std::string& clip, const AccelBuilder& build, Progress& progress) {
    const std::vector<Pose> poses = poses_of(rest, clip);
    BuiltPose best;
    double least = 0;
    for (const Pose& pose : poses) {
        if (progress.cancelled()) throw Cancelled();
        const auto scene = std::make_shared<const Scene>(posed(rest, pose));
        std::shared_ptr<const AccelData> accel = build(*scene, progress);
        const double cost = cost_in(poses, scene, accel, progress);
        if (best.accel && !(cost < least)) continue;
        least = cost;
        best = {scene, pose, std::move(accel)};
    }
    return best;
}

constexpr size_t kKeptCosts = 120;  // poses
constexpr size_t kShownTrees = 64;

std::string cost_text(double ratio) {
    char text[64];
    std::snprintf(text, sizeof text, "rays cost %.2f times what they cost after the last build", ratio);
    return text;
}

void note_cost(std::deque<float>& costs, double ratio) {
    costs.push_back(static_cast<float>(ratio));
    if (costs.size() > kKeptCosts) costs.pop_front();
}

}  // namespace

PoseFollower::Way way_of(const std::string& poses) {
    return poses == "refit"   ? PoseFollower::Way::refit
           : poses == "build" ? PoseFollower::Way::build
                              : PoseFollower::Way::automatic;
}

// Why nothing that is there can become the pose; empty: it can.
Problem PoseFollower::why_not(const PosedFrom& from, const Pose& pose) const {
    if (!mover_) return "the first pose";
    if (!(from == from_)) return "another scene or clip";
    if (mover_->cannot()) return mover_->cannot();
    if (deforming_meshes(pose) != deformed_) return "other meshes deform";
    return {};
}

// Why trees should be built anew, although they could be refitted; empty: they should not.
std::string PoseFollower::why_build(Way way) const {
    if (way == Way::build) return "the setting `poses` asks for it";
    if (way == Way::automatic && !beside_ && policy_.wants_build())
        return "slow rays have cost " + std::to_string(static_cast<long>(policy_.debt_ms())) + " ms since the last build";
    return {};
}

bool PoseFollower::wants_build_beside(const PosedFrom& from, const Pose& pose, Way way) const {
    return way == Way::automatic && !beside_ && !why_not(from, pose) && !mover_->can_build() && policy_.wants_build();
}

void PoseFollower::build_beside(const PosedFrom& from, std::shared_ptr<const Scene> scene, const Pose& pose,
                                const AccelBuilder& build) {
    beside_.reset(new Beside{
        from, BackgroundBuild([=](Progress& progress) -> BuiltPose { return {scene, pose, build(*scene, progress)}; })});
}

bool PoseFollower::wants_choice(const PosedFrom& from) const {
    return !from.at_rest && mover_ && from == from_ && !beside_ && !(from == chosen_for_) && !mover_->cannot() &&
           !mover_->can_build();
}

void PoseFollower::choose_beside(const PosedFrom& from, std::shared_ptr<const Scene> rest, const AccelBuilder& build) {
    chosen_for_ = from;
    beside_.reset(new Beside{
        from, BackgroundBuild([=](Progress& progress) { return choose_first_tree(*rest, from.clip, build, progress); })});
}

BuiltPose PoseFollower::take_build(const PosedFrom& from) {
    if (beside_ && !(beside_->from == from)) beside_.reset();
    if (!beside_ || !beside_->build.done()) return {};
    const std::unique_ptr<Beside> done = std::move(beside_);
    return done->build.take();
}

MovedStructure PoseFollower::refit(const PosedFrom& from, const std::shared_ptr<const Scene>& posed, const Pose& pose, Way way,
                                   double trace_ms, Progress& progress) {
    if (posed == posed_ && from == from_ && now_.accel) return now_;
    update_.followed = true;
    update_.building = beside_ != nullptr;
    update_.refitted = false;
    update_.why = why_not(from, pose).text();
    if (!update_.why.empty()) return {};
    const std::string why_build = this->why_build(way);
    const bool builds = !why_build.empty();
    update_.why = why_build;
    if (builds && !mover_->can_build()) return {};
    now_ = {};  // lets go of what the mover may write next
    MovedStructure moved = mover_->move(pose, builds, progress);
    if (!moved.accel) {
        update_.why = moved.why;
        return {};
    }
    update_.refitted = !builds;
    update_.ms = moved.ms;
    update_.primitives = builds ? 0 : moved.refitted;
    if (builds) {
        policy_.built(moved.ms - refit_ms_);
        note_cost(update_.cost_ratios, 1);
    } else {
        refit_ms_ = moved.ms;
        policy_.refitted(moved.worst_cost_ratio, trace_ms);
        update_.why = cost_text(moved.worst_cost_ratio);
        note_cost(update_.cost_ratios, moved.worst_cost_ratio);
    }
    note_trees(moved, *posed, builds);
    posed_ = posed;
    now_ = std::move(moved);
    return now_;
}

void PoseFollower::built(const PosedFrom& from, std::shared_ptr<const Scene> posed, const Pose& pose,
                         std::shared_ptr<const AccelData> accel, std::unique_ptr<PoseMover> mover) {
    if (!(from == from_)) {
        policy_ = {};
        refit_ms_ = 0;
        update_.cost_ratios.clear();
        update_.trees.clear();
    }
    const double ms = accel->build_ms + accel->pack_ms;
    policy_.built(ms - refit_ms_);
    update_.ms = ms;
    update_.primitives = 0;
    note_cost(update_.cost_ratios, 1);
    for (TreeUpdate& tree : update_.trees) {
        tree.what = "built";
        note_cost(tree.cost_ratios, 1);
    }
    from_ = from;
    deformed_ = deforming_meshes(pose);
    posed_ = std::move(posed);
    now_ = {};
    now_.accel = std::move(accel);
    mover_ = std::move(mover);
}

void PoseFollower::note_trees(const MovedStructure& moved, const Scene& scene, bool built) {
    const std::vector<rt_u32>& group_of_mesh = moved.accel->scene.group_of_mesh;
    std::vector<TreeUpdate>& trees = update_.trees;
    for (TreeUpdate& tree : trees) tree.what = "still";
    for (const MovedGroup& group : moved.groups) {
        const auto is_known = [&](const TreeUpdate& tree) {
            return tree.mesh == RT_NONE ? group.group == 0
                                        : tree.mesh < group_of_mesh.size() && group_of_mesh[tree.mesh] == group.group;
        };
        auto tree = std::find_if(trees.begin(), trees.end(), is_known);
        if (tree == trees.end()) {
            if (trees.size() == kShownTrees) continue;
            TreeUpdate added;
            if (group.group > 0) {
                const auto mesh = std::find(group_of_mesh.begin(), group_of_mesh.end(), group.group) - group_of_mesh.begin();
                added.mesh = static_cast<rt_u32>(mesh);
                if (added.mesh < scene.meshes.size()) added.name = scene.meshes[added.mesh].name;
            }
            tree = trees.insert(trees.end(), std::move(added));
        }
        tree->primitives = group.primitives;
        tree->what = built ? "built" : "refitted";
        note_cost(tree->cost_ratios, built ? 1.0 : group.cost_ratio);
    }
}

}  // namespace clarity
