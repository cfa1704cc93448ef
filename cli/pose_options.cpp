#include "cli/pose_options.hpp"

#include <cmath>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/numbers.hpp"

namespace clarity {
void check_pose(const PoseOptions& options) {
    if (options.time_s && !std::isfinite(*options.time_s))
        throw Error(Exit::usage, "--time: expected seconds on the clip's clock");
}

bool moves(const Scene& scene) {
    return !scene.motion.empty();
}

Scene at_pose(Scene scene, const PoseOptions& options, const FrameVertices& read) {
    if (!options.time_s && options.clip.empty()) return scene;
    const ClipInfo clip = find_clip(scene, options.clip);
    if (!moves(scene)) {
        log(LogLevel::warning, "--time " + exact_text(*options.time_s) + ": the scene does not move; leave --time out");
        return scene;
    }
    const Pose pose = evaluate(scene, clip.name, options.time_s.value_or(clip.begin_s), read);
    return posed(std::move(scene), pose);
}

}  // namespace clarity
