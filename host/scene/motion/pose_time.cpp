#include "scene/motion/pose_time.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/error.hpp"
#include "base/numbers.hpp"

namespace clarity {
namespace {

constexpr double kUsualFps = 24;
constexpr double kNear = 1e-4;  // of a frame: key times of files are rounded, 0.0416667 s is frame 1 at 24 frames a second

// A file may have keys at any time.
long whole(double number) {
    return static_cast<long>(std::clamp(number, -1e9, 1e9));
}

// The part of sample i is i * step modulo their number. A step near the golden section of it spreads samples that follow each
// other; one without a common divisor reaches every part.
uint64_t step_of(uint64_t count) {
    constexpr double kGolden = 0.6180339887498949;
    auto step = std::max<uint64_t>(1, static_cast<uint64_t>(std::llround(kGolden * static_cast<double>(count))));
    while (std::gcd(step, count) != 1) ++step;
    return step;
}

}  // namespace

bool same_pose(const PoseTime& a, const PoseTime& b) {
    return a.time_s == b.time_s && (!a.time_s || a.clip == b.clip);
}

ClipInfo find_clip(const Scene& scene, const std::string& text) {
    const std::vector<ClipInfo> all = clips(scene);
    if (text.empty()) return all.empty() ? ClipInfo() : all.front();
    for (const ClipInfo& clip : all)
        if (clip.name == text) return clip;
    size_t number = 0;
    if (read_number(text, number) && number < all.size()) return all[number];
    std::string names;
    for (size_t i = 0; i < all.size(); ++i)
        names += (i == 0 ? "" : ", ") + std::to_string(i) + " " + (all[i].name.empty() ? "(no name)" : all[i].name);
    throw Error(Exit::usage,
                "--clip " + text + ": the scene " + (names.empty() ? "has no clips" : "has no such clip, but " + names));
}

std::vector<ClipInfo> playable_clips(const Scene& scene) {
    std::vector<ClipInfo> all = clips(scene);
    const Motion& motion = scene.motion;
    if (!all.empty() || motion.frames.empty()) return all;
    ClipInfo whole;
    bool any = false;
    for (const VertexFrames& frames : motion.frames) {
        const double *const first = &motion.frame_times[frames.first_time], *const last = first + frames.frame_count - 1;
        whole.begin_s = any ? std::min(whole.begin_s, *first) : *first;
        whole.end_s = any ? std::max(whole.end_s, *last) : *last;
        any = true;
    }
    all.push_back(whole);
    return all;
}

double frame_rate(const ClipInfo& clip, double asked) {
    return asked > 0 ? asked : clip.fps > 0 ? clip.fps : kUsualFps;
}

FrameSpan frames_of(const ClipInfo& clip) {
    const double fps = frame_rate(clip);
    const FrameSpan span{whole(std::ceil(clip.begin_s * fps - kNear)), whole(std::floor(clip.end_s * fps + kNear))};
    return {span.first, std::max(span.first, span.last)};
}

long frame_at(double time_s, double fps) {
    return whole(std::round(time_s * fps));
}

double sample_time(const Shutter& shutter, unsigned sample) {
    if (shutter.samples <= 1 || !(shutter.open_s > 0)) return shutter.time_s;
    const uint64_t count = shutter.samples;
    // Sample 0 is near the picture's time: it is what a viewer sees first.
    const uint64_t part = (count / 2 + sample * step_of(count)) % count;
    return shutter.time_s + shutter.open_s * ((static_cast<double>(part) + 0.5) / static_cast<double>(count) - 0.5);
}

}  // namespace clarity
