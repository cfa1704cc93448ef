#include "ui/threads/picture.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <utility>

#include "picture/false_colors.hpp"
#include "scene/camera.hpp"
#include "tools/compare/picture_errors.hpp"
#include "view/settings/aov.hpp"

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

PictureDifference compare_pictures(const ByteImage& a, const ByteImage& b) {
    PictureDifference out;
    if (a.width != b.width || a.height != b.height) {
        out.mean = out.largest = 255;
        out.share = 1;
        return out;
    }
    std::vector<uint8_t> pixels(a.pixels.size());
    constexpr int kBrighter = 8;
    uint64_t sum = 0, differing = 0;
    int largest = 0;
    for (size_t i = 0; i + 3 < a.pixels.size(); i += 4) {
        int most = 0;
        for (size_t k = 0; k < 3; ++k) {
            const int d = std::abs(int(a.pixels[i + k]) - int(b.pixels[i + k]));
            sum += static_cast<uint64_t>(d);
            most = std::max(most, d);
            pixels[i + k] = static_cast<uint8_t>(std::min(255, d * kBrighter));
        }
        pixels[i + 3] = 255;
        differing += most > 1;
        largest = std::max(largest, most);
    }
    const double count = static_cast<double>(pixels.size()) / 4;
    if (count > 0) {
        out.mean = static_cast<double>(sum) / (3 * count);
        out.share = static_cast<double>(differing) / count;
    }
    out.largest = largest;
    out.image = {a.width, a.height, std::move(pixels)};
    return out;
}

bool Convergence::add(unsigned sample, double ms) {
    if (sample == 0) *this = {};
    seconds_ += ms / 1000;
    // 2, 3, 4, 6, 8, 12, ...
    unsigned samples = sample + 1;
    while (samples % 2 == 0 && samples > 2) samples /= 2;
    return samples == 2 || samples == 3;
}

void Convergence::put(const FilmNoise& noise, double rmse) {
    // Neither has a logarithm.
    const bool known = !points_.empty() && points_.back().samples == noise.mean_samples;
    if (noise.error > 0 && std::isfinite(noise.error) && !known)
        points_.push_back({noise.mean_samples, seconds_, noise.error, rmse});
}

double Convergence::slope() const {
    std::vector<std::pair<unsigned, double>> errors;
    for (const Point& point : points_) errors.emplace_back(unsigned(std::lround(point.samples)), point.error);
    return error_slope(errors);
}

void FrameTimes::add(const std::shared_ptr<const Ready>& of, const PictureSide& side) {
    constexpr size_t kTimes = 240;
    const bool same = of_ == of || (of_ && of && traces_alike(*of_, *of));
    of_ = of;
    if (!same || cold_) {
        frames_ms_.clear();
        kernels_ms_.clear();
        cold_ = !same;
    }
    const auto append = [](std::vector<float>& times, double ms) {
        times.push_back(static_cast<float>(ms));
        if (times.size() > kTimes) times.erase(times.begin());
    };
    append(frames_ms_, side.frame_ms);
    append(kernels_ms_, side.kernels_ms());
}

std::vector<float> FrameTimes::recent_kernels_ms() const {
    return {kernels_ms_.end() - std::min<std::ptrdiff_t>(30, kernels_ms_.end() - kernels_ms_.begin()), kernels_ms_.end()};
}

}  // namespace clarity::ui
