#include "cli/render/picture_tracer.hpp"

#include <algorithm>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "cli/render/render_progress.hpp"
#include "picture/frame_stats.hpp"

namespace clarity {
namespace {

// About how long a batch takes. Longer batches delay the progress bar; shorter ones make several devices wait for each other
// more often.
constexpr double kBatchMs = 100;
// A picture with checkpoints is not stopped in the middle of a batch that is shorter than this, because the film could not be
// saved then. The program's end may wait that long (interrupt.hpp).
constexpr double kWaitedForMs = 400;

}  // namespace

FrameStats PictureTracer::trace_samples(const Picture& picture, unsigned first, unsigned how_many, bool count,
                                        Progress& progress) {
    const FrameScene& scene = picture.scene;
    if (!picture.blur) return frames_.trace(picture.prepared, settings_, scene.view(), first, count, progress, how_many);
    FrameStats stats;
    for (unsigned i = first; i < first + how_many; ++i) {
        PartOf part(progress, double(i - first) / how_many, 1.0 / how_many);
        const MotionBlur::Sample& sample = picture.blur->at(i, scene.view(), part);
        const FrameStats one = frames_.trace(sample.prepared, settings_, scene.view(sample), i, count, part);
        add_stats(stats, one);
        add_shares(stats.devices, one.devices);
    }
    return stats;
}

PictureTracer::Traced PictureTracer::trace(const Picture& picture, const Pass& pass, Progress& progress) {
    RayCounts& counts = stats_;
    if (pass.counts) counts = {};
    const auto all = unsigned(settings_.spp);
    double device_ms = 0, wall_ms = 0;
    std::vector<DeviceShare> devices;
    unsigned sample = pass.first;
    for (unsigned next = std::min(all - sample, 2u); sample < all;) {
        // Nobody knows how many samples an error takes.
        const double at = pass.more ? -1 : pass.from + pass.share * sample / all;
        // A short sample is one launch, during which cancelling is not checked.
        if (!progress.report(float(at))) return {sample, true, false};
        PartOf part(progress, at, pass.more ? 0 : pass.share * next / all);
        Uncancelled whole(part);
        const unsigned done = sample - pass.first;
        const bool waits = pass.between && done > 0 && wall_ms / done * next < kWaitedForMs;
        FrameStats frame;
        try {
            frame = trace_samples(picture, sample, next, pass.counts, waits ? static_cast<Progress&>(whole) : part);
        } catch (const Cancelled&) {
            return {frames_.samples(), false, false};
        }
        device_ms += frame.device_ms;
        wall_ms += frame.wall_ms;
        add_shares(devices, frame.devices);
        if (pass.counts) counts += frame;
        sample += next;
        if (pass.between && sample < all) pass.between(sample);
        next = batch(wall_ms, sample - pass.first, all - sample);
        if (pass.at_most_doubles) next = std::min(next, sample - pass.first);
        if (pass.more && sample < all) {
            const unsigned more = pass.more(sample);
            if (more == 0) break;
            next = std::min(next, more);
        }
        if (ranks_ && (pass.between || pass.more)) {  // all ranks save the same samples
            const std::vector<double> of_ranks = ranks_->gather(next);
            next = unsigned(*std::min_element(of_ranks.begin(), of_ranks.end()));
        }
    }
    stats_.shares = devices;
    if (pass.counts && counts.not_finite > 0) log(LogLevel::error, not_finite_text(counts.not_finite));
    if (pass.timed) {
        stats_.frame_ms.push_back(device_ms);
        stats_.wall_ms.push_back(wall_ms);
    }
    return {sample, true, true};
}

// Number of samples to trace in the next batch, after `done` samples took wall_ms.
unsigned PictureTracer::batch(double wall_ms, unsigned done, unsigned left) {
    const double each = std::max(wall_ms / done, 1e-3);
    return std::min(unsigned(std::clamp(kBatchMs / each, 1.0, 1024.0)), left);
}

}  // namespace clarity
