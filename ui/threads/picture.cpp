#include "ui/threads/picture.hpp"

#include <algorithm>
#include <numeric>

#include "render/settings/aov.hpp"
#include "scene/camera.hpp"

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

void Surroundings::put_around(Picture& picture) {
    PictureSide* const sides[] = {&picture.main, picture.other ? &*picture.other : nullptr};
    const std::shared_ptr<const void> loaded = picture.job.ready->loaded;
    const bool whole = picture.main.settings.crop.whole_width == 0;
    const bool known = loaded_.lock() == loaded && same_camera(camera_, picture.job.view.camera);
    for (size_t i = 0; i < 2; ++i)
        if (whole)
            images_[i] = sides[i] ? sides[i]->image : ByteImage();
        else if (sides[i])
            sides[i]->image = in_whole(sides[i]->image, sides[i]->settings, known ? images_[i] : ByteImage());
    if (whole) {
        camera_ = picture.job.view.camera;
        loaded_ = loaded;
    } else if (picture.difference) {
        picture.difference->image = in_whole(picture.difference->image, picture.main.settings, {});
    }
}

}  // namespace clarity::ui
