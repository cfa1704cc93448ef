#include "render/moving/follow/first_tree.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.hpp"
#include "render/moving/on_host/host_mover.hpp"
#include "scene/motion/pose.hpp"

namespace clarity {
namespace {

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

}  // namespace

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

}  // namespace clarity
