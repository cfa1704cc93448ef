// background_build.hpp -- a build on a thread of its own, while the structure that is there goes on.
//
// It builds the trees of all meshes. rt_build_input::wanted would allow for those that have decayed alone: docs/experiments.md
// (Refits) says what that would gain.
#pragma once
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <utility>

#include "base/progress.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"

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
    explicit BackgroundBuild(Build build)
        : result_(std::async(std::launch::async, [this, build = std::move(build)] { return build(progress_); })) {}
    // Cancels the build and waits for its end.
    ~BackgroundBuild() {
        progress_.cancel();
        if (result_.valid()) result_.wait();
    }
    BackgroundBuild(const BackgroundBuild&) = delete;
    BackgroundBuild& operator=(const BackgroundBuild&) = delete;

    // Before take().
    bool done() const { return result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
    // The result, once, or what the build threw. Waits for it.
    BuiltPose take() { return result_.get(); }

 private:
    Progress progress_;
    std::future<BuiltPose> result_;  // last member: its thread uses the others
};

}  // namespace clarity
