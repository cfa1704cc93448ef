#include "ui/session/figures.hpp"

#include <algorithm>
#include <cstdio>

namespace clarity::ui {

double frames_per_second(const Session& session, unsigned side) {
    const std::vector<float> times = session.frame_times(side).frames_ms();
    const size_t count = std::min<size_t>(times.size(), 10);
    double sum = 0;
    for (size_t i = times.size() - count; i < times.size(); ++i) sum += times[i];
    return sum > 0 ? 1000.0 * static_cast<double>(count) / sum : 0.0;
}

double mrays_per_second(const Session& session, unsigned side) {
    const std::shared_ptr<const Picture> picture = session.picture();
    if (!picture || (side == 1 && !picture->other)) return 0;
    const FrameStats& stats = side == 1 ? picture->other->stats : picture->main.stats;
    const double ms = stats.device_ms > 0 ? stats.device_ms : stats.wall_ms;
    return ms > 0 ? static_cast<double>(stats.primary + stats.shadow + stats.secondary) / ms * 1e-3 : 0;
}

std::string frame_rate_line(const Session& session) {
    const std::shared_ptr<const Picture> picture = session.picture();
    if (!picture) return "fps 0.0  no picture yet";
    const Settings& s = picture->main.settings;
    const double fps = frames_per_second(session);
    char text[256];
    std::snprintf(text, sizeof text, "fps %.1f  %.1f ms  %.1f Mrays/s  %dx%d  %s  packet %dx%d  lanes %d  depth %d", fps,
                  fps > 0 ? 1000.0 / fps : 0.0, mrays_per_second(session), s.width, s.height, s.accel.c_str(), s.packet_w,
                  s.packet_h, s.lanes, s.depth);
    return text;
}

}  // namespace clarity::ui
