#include "stand/multi_frame_renderer.hpp"

#include <algorithm>
#include <utility>

#include "base/progress.hpp"
#include "device/cl_errors.hpp"
#include "frames/frame_renderer.hpp"
#include "kernels/program_cache.hpp"
#include "launch/frame_constants.hpp"
#include "picture/film.hpp"
#include "picture/film_noise.hpp"
#include "picture/frame_stats.hpp"
#include "picture/pinned_memory_pool.hpp"
#include "stand/multi_device_film.hpp"
#include "view/settings/aov.hpp"

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
    // For several devices: the whole picture on one of them, for the denoiser.
    std::unique_ptr<FrameRenderer> gathered;
    std::shared_ptr<Device> gathered_on;
    // Of the last look, if no sample was added since: after how many samples it was, and how many pixels had too large an
    // error.
    unsigned looked_at = 0;
    uint64_t noisy = 0;

    const Aov& aov() const { return find_aov(prepared->first()->settings.aov); }
    FloatImage image(unsigned channels) const {
        FloatImage image{width, height, channels, {}};
        image.pixels.resize(size_t(width) * height * channels);
        return image;
    }

    FrameStats trace(const Settings& settings, const View& view, unsigned sample, unsigned end, bool count_rays,
                     Progress& progress, const std::function<void()>& meanwhile) {
        looked_at = 0;
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

    // The first planes of the film.
    FloatImage planes(unsigned count) {
        FloatImage sums = image(aov().film_channels());
        const size_t in_plane = sums.pixels.size();
        sums.height *= count;
        sums.pixels.resize(in_plane * count);
        if (alone)
            alone->read_sums(sums);
        else
            shared->read([&](size_t, FrameRenderer& frames) { frames.read_sums(sums); });
        for (unsigned plane = 0; plane < count; ++plane) collect(sums.channels * sizeof(float), &sums.pixels[plane * in_plane]);
        return sums;
    }

    bool has_guides() const { return prepared->first()->program->row.has(kGuides); }

    // The film of all devices and ranks on the first device that works; null: this rank is not the first.
    FrameRenderer* gather(const Settings& settings) {
        const FloatImage sums = planes(prepared->planes());
        if (ranks && ranks->rank() != 0) return nullptr;
        size_t first = 0;
        while (first + 1 < shared->size() && !(shared->works(first) && prepared->of(shared->device(first)))) ++first;
        const std::shared_ptr<Device> device = shared->device(first);
        if (!gathered || gathered_on != device) gathered = std::make_unique<FrameRenderer>(device);
        gathered_on = device;
        gathered->write_sums(**prepared->of(device), settings, sums);
        return gathered.get();
    }

    // Decides whether and where devices display the picture during trace(); null: they do not.
    uint8_t* place_for_display(const Settings& settings) {
        display = nullptr;
        display_tones = Tones(settings);
        if (!std::exchange(shown, false) || !aov().is_color() || denoises(settings)) return nullptr;
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
    const double bound = prepared->planes() > 1 ? adaptive_bound(settings) : 0;
    if (bound == 0) return im.trace(settings, view, sample, end, count_rays, progress, meanwhile);
    FrameStats all;
    for (unsigned first = sample; first < end;) {
        if (is_look(first)) look(settings, first);
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
    return impl_->prepared->planes();
}

bool MultiFrameRenderer::has_guides() const {
    return impl_->has_guides();
}

FloatImage MultiFrameRenderer::read_sums() {
    return impl_->planes(planes());
}

FilmNoise MultiFrameRenderer::noise() {
    return film_noise(impl_->planes(2));
}

uint64_t MultiFrameRenderer::look(const Settings& settings, unsigned samples) {
    Impl& im = *impl_;
    if (im.looked_at == samples) return im.noisy;
    auto sums = std::make_shared<FloatImage>(read_sums());
    im.noisy = mark_resting(*sums, adaptive_bound(settings), samples, planes());
    resume(im.prepared, settings, std::move(sums), samples);
    im.looked_at = samples;
    return im.noisy;
}

void MultiFrameRenderer::resume(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                                std::shared_ptr<const FloatImage> sums, unsigned samples) {
    Impl& im = *impl_;
    im.prepared = prepared;
    im.width = unsigned(settings.width);
    im.height = unsigned(settings.height);
    im.samples = samples;
    im.looked_at = 0;
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

FloatImage MultiFrameRenderer::read_picture(const Settings& settings) {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_picture(settings);
    if (!denoises(settings) || !im.has_guides()) return read_values();
    FrameRenderer* const whole = im.gather(settings);
    return whole ? whole->read_picture(settings) : im.image(3);
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
    if (denoises(settings) && im.has_guides()) {
        FrameRenderer* const whole = im.gather(settings);
        return whole ? whole->read_display(settings, stats) : ByteImage{};
    }
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

rt_frame frame_constants(const View& view, const Settings& settings) {
    return make_frame(view, settings, Layout(), AccelData(), 0);
}

}  // namespace clarity
