// background_build.hpp -- a build on a thread of its own, while the structure that is there goes on.
#pragma once
#include <atomic>
#include <functional>
#include <future>
#include <memory>

#include "base/progress.hpp"
#include "render/accel/accel_build.hpp"

namespace clarity {

class BackgroundBuild {
 public:
    // Called on the other thread. May throw.
    using Build = std::function<std::shared_ptr<const AccelData>(Progress&)>;
    explicit BackgroundBuild(Build build);
    // Cancels the build and waits for its end.
    ~BackgroundBuild();
    BackgroundBuild(const BackgroundBuild&) = delete;
    BackgroundBuild& operator=(const BackgroundBuild&) = delete;

    bool done() const { return done_; }
    // The result, once, or what the build threw. Waits for it.
    std::shared_ptr<const AccelData> take() { return result_.get(); }

 private:
    Progress progress_;
    std::atomic<bool> done_{false};
    std::future<std::shared_ptr<const AccelData>> result_;  // last member: its thread uses the others
};

}  // namespace clarity
