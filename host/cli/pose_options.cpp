#include "cli/pose_options.hpp"

#include <cmath>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/numbers.hpp"

namespace clarity {
namespace {

constexpr double kUsualFps = 24;

// The clip of a name; the first one for "". Throws Error(usage) if there is none, except for "" and a scene without clips.
ClipInfo find_clip(const Scene& scene, const std::string& name) {
    std::string names;
    for (const ClipInfo& clip : clips(scene)) {
        if (name.empty() || clip.name == name) return clip;
        names += (names.empty() ? "" : ", ") + (clip.name.empty() ? "(no name)" : clip.name);
    }
    if (name.empty()) return {};
    throw Error(Exit::usage,
                "--clip " + name + ": the scene " + (names.empty() ? "has no clips" : "has no such clip, but " + names));
}

}  // namespace

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
    const Pose pose = evaluate(scene, options.clip, options.time_s.value_or(clip.begin_s), read);
    return posed(std::move(scene), pose);
}

double time_of_frame(const Scene& scene, const std::string& clip, double fps, int number) {
    const double own = find_clip(scene, clip).fps;
    return number / (fps > 0 ? fps : own > 0 ? own : kUsualFps);
}

}  // namespace clarity
