#include "render/moving/follow/background_build.hpp"

#include <utility>

namespace clarity {

BackgroundBuild::BackgroundBuild(Build build) {
    result_ = std::async(std::launch::async, [this, build = std::move(build)] {
        struct Ends {
            std::atomic<bool>& done;
            ~Ends() { done = true; }
        } ends{done_};
        return build(progress_);
    });
}

BackgroundBuild::~BackgroundBuild() {
    progress_.cancel();
    if (result_.valid()) result_.wait();
}

}  // namespace clarity
