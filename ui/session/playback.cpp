#include "ui/session/playback.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::ui {
namespace {

// A time in the loop: what lies past one end comes in at the other.
double wrapped(double time_s, const std::array<double, 2>& loop) {
    const double length = loop[1] - loop[0];
    if (!(length > 0)) return loop[0];
    const double past = std::fmod(time_s - loop[0], length);
    return loop[0] + (past < 0 ? past + length : past);
}

bool within(double time_s, const std::array<double, 2>& loop) {
    return time_s >= loop[0] && time_s < loop[1];
}

}  // namespace

void Playback::open(const Scene& scene, DesiredState& desired) {
    clips_ = playable_clips(scene);
    playing_ = held_ = has_stage_ = false;
    desired.pose = {};
    desired.loop = {};
    desired.speed = 1;
    if (!any()) return;
    desired.pose.clip = clips_.front().name;
    desired.loop = {clips_.front().begin_s, clips_.front().end_s};
}

void Playback::offer_stage(DesiredState& desired, double until_s) {
    constexpr double kSeconds = 10;
    if (any() && !has_stage_) return;
    const double end_s = std::max(kSeconds, std::ceil(until_s));
    if (has_stage_ && clips_.front().end_s >= end_s) return;
    has_stage_ = true;
    clips_ = {ClipInfo()};
    clips_.front().end_s = end_s;
    desired.pose.clip.clear();
    desired.loop = {0, end_s};
}

bool Playback::has(const std::string& clip) const {
    return std::any_of(clips_.begin(), clips_.end(), [&](const ClipInfo& info) { return info.name == clip; });
}

const ClipInfo& Playback::clip(const DesiredState& desired) const {
    const auto named = [&](const ClipInfo& info) { return info.name == desired.pose.clip; };
    const auto found = std::find_if(clips_.begin(), clips_.end(), named);
    return found == clips_.end() ? clips_.front() : *found;
}

void Playback::play(DesiredState& desired) {
    if (!any() || playing_) return;
    // Undo may have taken the loop back to when a still scene had no timeline.
    if (has_stage_ && !(desired.loop[1] > desired.loop[0])) desired.loop = {clips_.front().begin_s, clips_.front().end_s};
    if (!desired.pose.time_s || !within(*desired.pose.time_s, desired.loop)) desired.pose.time_s = desired.loop[0];
    playing_ = true;
    last_s_ = 0;
}

void Playback::pause(DesiredState& desired) {
    if (!playing_) return;
    playing_ = false;
    if (desired.pose.time_s) show(desired, *desired.pose.time_s);
}

void Playback::show(DesiredState& desired, double time_s) {
    if (!any()) return;
    const FrameSpan span = frames_of(clip(desired));
    const long frame = std::clamp(frame_at(time_s, fps(desired)), span.first, span.last);
    desired.pose.time_s = time_of_frame(static_cast<double>(frame), fps(desired));
}

void Playback::step(DesiredState& desired, int frames) {
    if (!any()) return;
    pause(desired);
    if (!desired.pose.time_s) return show(desired, desired.loop[frames > 0 ? 0 : 1]);
    const double rate = fps(desired);
    const FrameSpan span = frames_of(clip(desired));
    constexpr double kNear = 1e-4;  // of a frame
    const auto first = std::max(span.first, static_cast<long>(std::ceil(desired.loop[0] * rate - kNear)));
    const auto last = std::min(span.last, static_cast<long>(std::floor(desired.loop[1] * rate + kNear)));
    long frame = frame_at(*desired.pose.time_s, rate);
    const bool inside = frame >= first && frame <= last;
    frame += frames;
    // A time outside of the loop may be stepped to the ends of the clip.
    const long low = inside ? first : span.first, high = inside ? last : span.last;
    if (frame > high) frame = low;
    if (frame < low) frame = high;
    show(desired, time_of_frame(static_cast<double>(frame), rate));
}

void Playback::rest(DesiredState& desired) {
    playing_ = false;
    desired.pose.time_s.reset();
}

void Playback::choose(DesiredState& desired, const std::string& name) {
    if (!has(name)) return;
    desired.pose.clip = name;
    const ClipInfo& chosen = clip(desired);
    desired.loop = {chosen.begin_s, chosen.end_s};
    show(desired, chosen.begin_s);
}

void Playback::set_loop(DesiredState& desired, double from_s, double to_s) {
    if (!any()) return;
    const ClipInfo& chosen = clip(desired);
    const double frame = std::min(1 / fps(desired), chosen.end_s - chosen.begin_s);
    const double from = std::clamp(from_s, chosen.begin_s, chosen.end_s - frame);
    desired.loop = {from, std::max(from + frame, std::min(to_s, chosen.end_s))};
}

void Playback::advance(DesiredState& desired, double now_s) {
    const double passed = last_s_ > 0 ? now_s - last_s_ : 0;
    last_s_ = now_s;
    if (!any() || !playing_ || held_) return;
    if (!desired.pose.time_s) {  // the desired state was set back to the scene at rest
        playing_ = false;
        return;
    }
    desired.pose.time_s = wrapped(*desired.pose.time_s + passed * double(desired.speed), desired.loop);
}

void Playback::set_camera_key(DesiredState& desired) {
    if (!any()) offer_stage(desired, 0);
    if (!desired.pose.time_s) show(desired, desired.loop[0]);
    pause(desired);
    desired.camera_path.set(*desired.pose.time_s, desired.camera);
}

void Playback::remove_camera_key(DesiredState& desired) {
    if (!desired.pose.time_s) return;
    const int key = desired.camera_path.key_at(*desired.pose.time_s);
    if (key >= 0) desired.camera_path.keys.erase(desired.camera_path.keys.begin() + key);
}

}  // namespace clarity::ui
