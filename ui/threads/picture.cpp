#include "ui/threads/picture.hpp"

#include <algorithm>
#include <numeric>

#include "render/settings/aov.hpp"

namespace clarity::ui {

Settings frame_settings(const Settings& prepared, const Settings& desired_now) {
    Settings settings = prepared;
    for (const Setting& row : settings_table())
        if (row.at_once()) row.copy(settings, desired_now);
    return settings;
}

double PictureSide::kernels_ms() const {
    return std::accumulate(stats.kernels.begin(), stats.kernels.end(), 0.0,
                           [](double ms, const KernelTime& kernel) { return ms + kernel.ms; });
}

FrameStats traced_part(FrameStats stats) {
    const auto shown = std::find_if(stats.kernels.begin(), stats.kernels.end(),
                                    [](const KernelTime& time) { return time.name != "trace" && time.name != "counters"; });
    stats.kernels.erase(shown, stats.kernels.end());
    return stats;
}

void share_scale(PictureSide& a, PictureSide& b) {
    if (a.settings.aov != b.settings.aov || !a.values || !b.values || a.scale.max == b.scale.max) return;
    if (find_aov(a.settings.aov).about != Aov::About::cost) return;  // only costs can be compared by their colours
    PictureSide& shorter = a.scale.max < b.scale.max ? a : b;
    shorter.scale = scale_of(*shorter.values, shorter.settings.aov, std::max(a.scale.max, b.scale.max));
    shorter.image = false_colors(*shorter.values, shorter.settings.aov, shorter.scale);
}

void keep_image(PictureSide& side, const PictureSide& finished) {
    side.image = finished.image;
    side.scale = finished.scale;
    side.values = finished.values;
    side.convergence = finished.convergence;
    side.stats.samples = finished.stats.samples;
}

}  // namespace clarity::ui
