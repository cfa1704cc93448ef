// background_build.hpp -- a build on a thread of its own, while the structure that is there goes on.
//
// It builds the trees of all meshes. rt_build_input::wanted would allow for those that have decayed alone: docs/experiments.md
// (Refits) says what that would gain.
#pragma once
#include <atomic>
#include <functional>
#include <future>
#include <memory>

#include "base/progress.hpp"
#include "render/accel/accel_build.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"

namespace clarity {

// A structure, and the scene and the pose that it was built for.
struct BuiltPose {
    std::shared_ptr<const Scene> scene;
    Pose pose;
    std::shared_ptr<const AccelData> accel;
};

class BackgroundBuild {
 public:
    // Called on the other thread. May throw.
    using Build = std::function<BuiltPose(Progress&)>;
    explicit BackgroundBuild(Build build);
    // Cancels the build and waits for its end.
    ~BackgroundBuild();
    BackgroundBuild(const BackgroundBuild&) = delete;
    BackgroundBuild& operator=(const BackgroundBuild&) = delete;

    bool done() const { return done_; }
    // The result, once, or what the build threw. Waits for it.
    BuiltPose take() { return result_.get(); }

 private:
    Progress progress_;
    std::atomic<bool> done_{false};
    std::future<BuiltPose> result_;  // last member: its thread uses the others
};

}  // namespace clarity
