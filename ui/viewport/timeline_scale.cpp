#include "ui/viewport/timeline_scale.hpp"

#include <algorithm>
#include <cmath>

namespace clarity::ui {

float TimelineScale::place_of(double time_s) const {
    const double length = end_s - begin_s;
    const double share = length > 0 ? std::clamp((time_s - begin_s) / length, 0.0, 1.0) : 0.0;
    return left + static_cast<float>(share) * (right - left);
}

double TimelineScale::time_at(float place) const {
    const float width = right - left;
    const double share = width > 0 ? std::clamp(double(place - left) / double(width), 0.0, 1.0) : 0.0;
    return begin_s + share * (end_s - begin_s);
}

long mark_step(const TimelineScale& scale, double fps, float least) {
    const double frames = (scale.end_s - scale.begin_s) * fps;
    const double needed = frames * double(least) / std::max(double(scale.right - scale.left), 1.0);
    for (double ten = 1; ten < 1e9; ten *= 10)
        for (const double digit : {1.0, 2.0, 5.0})
            if (ten * digit >= needed) return static_cast<long>(ten * digit);
    return 1000000000;
}

std::vector<long> marked_frames(const TimelineScale& scale, double fps, long step) {
    std::vector<long> frames;
    constexpr double kNear = 1e-4;  // of a frame
    const double first = std::ceil((scale.begin_s * fps - kNear) / double(step)), last = scale.end_s * fps + kNear;
    if (!(std::fabs(first * double(step)) < 1e15)) return frames;  // a file may have keys at any time
    for (double n = first * double(step); n <= last && frames.size() < 1000; n += double(step))
        frames.push_back(static_cast<long>(n));
    return frames;
}

}  // namespace clarity::ui
