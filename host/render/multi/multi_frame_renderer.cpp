#include "render/multi/multi_frame_renderer.hpp"

#include <algorithm>
#include <utility>

#include "base/part_of_progress.hpp"
#include "device/cl_errors.hpp"
#include "render/film/film.hpp"
#include "render/film/film_noise.hpp"
#include "render/film/pinned_memory_pool.hpp"
#include "render/frame/frame_stats.hpp"
#include "render/kernels/program_cache.hpp"
#include "render/multi/multi_device_film.hpp"
#include "render/settings/aov.hpp"

namespace clarity {

struct MultiFrameRenderer::Impl {
    std::unique_ptr<FrameRenderer> alone;  // used if there is only one device; the rest is then unused
    std::unique_ptr<MultiDeviceFilm> shared;
    Ranks* ranks = nullptr;  // nullptr: this process traces the whole picture
    // The picture that was traced last.
    std::shared_ptr<const MultiPrepared> prepared;
    unsigned width = 0, height = 0;
    unsigned samples = 0;  // of `alone`
    std::unique_ptr<PinnedMemoryPool> memory;
    std::shared_ptr<Device> memory_of;
    // For several devices. If the last picture was displayed, we expect that of the next one too: each device then copies its
    // displayed rows to `display` as soon as it has traced them, with these tones.
    bool shown = false;
    std::shared_ptr<uint8_t> display;
    Tones display_tones;

    const Aov& aov() const { return find_aov(prepared->first()->settings.aov); }
    FloatImage image(unsigned channels) const {
        FloatImage image{width, height, channels, {}};
        image.pixels.resize(size_t(width) * height * channels);
        return image;
    }

    FrameStats trace(const Settings& settings, const View& view, unsigned sample, unsigned end, bool count_rays,
                     Progress& progress, const std::function<void()>& meanwhile) {
        if (shared) {
            if (meanwhile) meanwhile();
            return shared->trace(prepared, settings, view, sample, end, count_rays, progress, place_for_display(settings));
        }
        samples = sample;
        const auto complete = [&](unsigned done) {
            samples = done;
            return done == end || progress.report(float(done - sample) / float(end - sample));
        };
        return alone->trace(*prepared->first(), settings, view, {sample, end - sample, complete}, count_rays, progress, nullptr,
                            meanwhile);
    }

    // Completes the picture of rank 0.
    void collect(size_t pixel_bytes, void* picture) const {
        if (ranks) collect_rows(*ranks, shared->rows(), width * pixel_bytes, height, static_cast<char*>(picture));
    }

    // Returns memory that all devices write to. It is pinned by the first GPU that works.
    std::shared_ptr<uint8_t> room(size_t bytes) {
        std::shared_ptr<Device> gpu;
        for (size_t i = 0; i < shared->size() && !gpu; ++i)
            if (shared->works(i) && !shared->device(i)->info().cpu) gpu = shared->device(i);
        if (!memory || memory_of != gpu) memory = std::make_unique<PinnedMemoryPool>(gpu);
        memory_of = gpu;
        return gpu ? wrap_cl_errors(*gpu, "reading the picture", [&] { return memory->lend(bytes); }) : memory->lend(bytes);
    }

    // Decides whether and where devices display the picture during trace(); null: they do not.
    uint8_t* place_for_display(const Settings& settings) {
        display = nullptr;
        display_tones = Tones(settings);
        if (!std::exchange(shown, false) || !aov().is_color()) return nullptr;
        try {
            display = room(size_t(width) * height * 4);
        } catch (const Error&) {  // the GPU is lost; tracing will report it
        }
        return display.get();
    }
};

MultiFrameRenderer::MultiFrameRenderer(const Devices& devices, Ranks* ranks) : impl_(std::make_unique<Impl>()) {
    impl_->ranks = ranks;
    if (devices.size() == 1 && !ranks)
        impl_->alone = std::make_unique<FrameRenderer>(devices[0]);
    else
        impl_->shared = std::make_unique<MultiDeviceFilm>(devices, ranks);
}
MultiFrameRenderer::~MultiFrameRenderer() = default;

unsigned MultiFrameRenderer::samples() const {
    return impl_->alone ? impl_->samples : impl_->shared->samples();
}

FrameStats MultiFrameRenderer::trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                                     const View& view, unsigned sample, bool count_rays, Progress& progress, unsigned samples,
                                     const std::function<void()>& meanwhile) {
    Impl& im = *impl_;
    im.prepared = prepared;
    im.width = unsigned(settings.width);
    im.height = unsigned(settings.height);
    const unsigned end = sample + samples;
    // With `adaptive` the picture depends on the first samples of all of its pixels, and on nothing else that is traced.
    const double bound = planes() > 1 ? adaptive_bound(settings) : 0;
    if (bound == 0) return im.trace(settings, view, sample, end, count_rays, progress, meanwhile);
    FrameStats all;
    for (unsigned first = sample; first < end;) {
        if (is_look(first)) {
            auto sums = std::make_shared<FloatImage>(read_sums());
            mark_resting(*sums, bound, first);
            resume(prepared, settings, std::move(sums), first);
        }
        const unsigned until = std::min(end, next_look(first));
        PartOf part(progress, double(first - sample) / samples, double(until - first) / samples);
        const FrameStats some = im.trace(settings, view, first, until, count_rays, part, first == sample ? meanwhile : nullptr);
        add_stats(all, some);
        add_shares(all.devices, some.devices);
        first = until;
    }
    return all;
}

unsigned MultiFrameRenderer::planes() const {
    return film_planes(impl_->prepared->first()->program->row);
}

FloatImage MultiFrameRenderer::read_sums() {
    Impl& im = *impl_;
    FloatImage image = im.image(im.aov().film_channels());
    image.height *= planes();
    image.pixels.resize(image.pixels.size() * planes());
    if (im.alone)
        im.alone->read_sums(image);
    else
        im.shared->read([&](size_t, FrameRenderer& frames) { frames.read_sums(image); });
    for (unsigned plane = 0; plane < planes(); ++plane)
        im.collect(image.channels * sizeof(float), &image.pixels[plane * (image.pixels.size() / planes())]);
    return image;
}

void MultiFrameRenderer::resume(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                                std::shared_ptr<const FloatImage> sums, unsigned samples) {
    Impl& im = *impl_;
    im.prepared = prepared;
    im.width = unsigned(settings.width);
    im.height = unsigned(settings.height);
    im.samples = samples;
    if (im.alone)
        im.alone->write_sums(*prepared->first(), settings, *sums);
    else
        im.shared->resume(std::move(sums), samples);
}

FloatImage MultiFrameRenderer::read_values() {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_values();
    FloatImage image = im.image(im.aov().value_channels());
    im.shared->read([&](size_t, FrameRenderer& frames) { frames.read_values(image); });
    im.collect(image.channels * sizeof(float), image.pixels.data());
    return image;
}

FloatImage MultiFrameRenderer::read_distance() {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_distance();
    if (!im.prepared) return {};
    FloatImage image = im.image(1);
    std::vector<char> known(im.shared->size(), true);
    im.shared->read([&](size_t i, FrameRenderer& frames) { known[i] = frames.read_distance(image); });
    im.collect(sizeof(float), image.pixels.data());
    return std::find(known.begin(), known.end(), false) == known.end() ? image : FloatImage{};
}

ByteImage MultiFrameRenderer::read_display(const Settings& settings, FrameStats* stats, FalseColorScale* scale) {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_display(settings, stats, scale);
    if (scale) *scale = {};
    if (!im.aov().is_color())
        return show_values([this] { return read_values(); }, im.aov().name, settings, stats ? &stats->kernels : nullptr, scale);
    im.shown = true;
    const size_t bytes = size_t(im.width) * im.height * 4;
    std::vector<std::vector<KernelTime>> times(im.shared->size());
    std::shared_ptr<uint8_t> rgba = std::exchange(im.display, nullptr);
    if (!rgba || !(im.display_tones == Tones(settings)) || !im.shared->displayed(times)) {
        rgba = im.room(bytes);
        im.shared->read([&](size_t i, FrameRenderer& frames) {
            times[i].clear();
            frames.read_display(settings, rgba.get(), times[i]);
        });
    }
    im.collect(4, rgba.get());
    for (size_t i = 0; stats && i < times.size(); ++i) {
        merge_times(stats->kernels, times[i]);
        for (DeviceShare& share : stats->devices)
            if (share.id == im.shared->device(i)->info().id())
                for (const KernelTime& time : times[i]) (time.name == "tone map" ? share.tone_map_ms : share.read_ms) = time.ms;
    }
    return {im.width, im.height, SharedBytes(rgba, bytes)};
}

AsyncReadback MultiFrameRenderer::begin_display(const Settings& settings) {
    return impl_->alone->begin_display(settings);
}

bool MultiFrameRenderer::overlaps_copies() const {
    return impl_->alone && impl_->alone->overlaps_copies();
}

}  // namespace clarity
