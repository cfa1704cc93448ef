#include "render/multi_frames.hpp"

#include <algorithm>

#include "render/film.hpp"
#include "render/guarded.hpp"
#include "render/host_memory.hpp"
#include "render/shared_picture.hpp"

namespace clarity {

struct MultiFrames::Impl {
    std::unique_ptr<Frames> alone;  // of the only device, which needs nothing of the rest
    std::unique_ptr<SharedPicture> shared;
    // The picture traced last.
    std::shared_ptr<const MultiPrepared> prepared;
    unsigned width = 0, height = 0;
    unsigned samples = 0;  // of `alone`
    std::unique_ptr<HostMemory> memory;
    std::shared_ptr<Device> memory_of;

    const std::string& aov() const { return prepared->first()->settings.aov; }
    FloatImage image(unsigned channels) const {
        FloatImage image{width, height, channels, {}};
        image.pixels.resize(size_t(width) * height * channels);
        return image;
    }

    // Room that all devices write to; pinned by the first GPU.
    std::shared_ptr<uint8_t> room(size_t bytes) {
        std::shared_ptr<Device> gpu;
        for (size_t i = 0; i < shared->size() && !gpu; ++i)
            if (shared->works(i) && !shared->device(i)->info().cpu) gpu = shared->device(i);
        if (!memory || memory_of != gpu) memory = std::make_unique<HostMemory>(gpu);
        memory_of = gpu;
        return gpu ? guarded(*gpu, "reading the picture", [&] { return memory->lend(bytes); }) : memory->lend(bytes);
    }
};

MultiFrames::MultiFrames(const Devices& devices, unsigned queues) : impl_(std::make_unique<Impl>()) {
    if (devices.size() == 1 && queues < 2)
        impl_->alone = std::make_unique<Frames>(devices[0]);
    else
        impl_->shared = std::make_unique<SharedPicture>(devices, queues);
}
MultiFrames::~MultiFrames() = default;

unsigned MultiFrames::samples() const {
    return impl_->alone ? impl_->samples : impl_->shared->samples();
}

FrameStats MultiFrames::trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings, const View& view,
                              unsigned sample, bool count_rays, Progress& progress, unsigned samples,
                              const std::function<void()>& meanwhile) {
    Impl& im = *impl_;
    im.prepared = prepared;
    im.width = unsigned(settings.width);
    im.height = unsigned(settings.height);
    const unsigned end = sample + samples;
    if (im.shared && meanwhile) meanwhile();
    if (im.shared) return im.shared->trace(prepared, settings, view, sample, end, count_rays, progress);
    im.samples = sample;
    FrameStats sum;
    for (unsigned s = sample; s < end; ++s) {
        if (s > sample && !progress.report(float(s - sample) / float(samples))) throw Cancelled();
        const FrameStats one = im.alone->trace(*prepared->first(), settings, view, s, count_rays, progress, nullptr,
                                               s == sample ? meanwhile : nullptr);
        im.samples = s + 1;
        add_stats(sum, one);
    }
    return sum;
}

FloatImage MultiFrames::read_values() {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_values();
    FloatImage image = im.image(value_channels(im.aov()));
    im.shared->read([&](size_t, Frames& frames) { frames.read_values(image); });
    return image;
}

FloatImage MultiFrames::read_distance() {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_distance();
    if (!im.prepared) return {};
    FloatImage image = im.image(1);
    std::vector<char> known(im.shared->size(), true);
    im.shared->read([&](size_t i, Frames& frames) { known[i] = frames.read_distance(image); });
    return std::find(known.begin(), known.end(), false) == known.end() ? image : FloatImage{};
}

ByteImage MultiFrames::read_display(const Settings& settings, FrameStats* stats, FalseColorScale* scale) {
    Impl& im = *impl_;
    if (im.alone) return im.alone->read_display(settings, stats, scale);
    if (scale) *scale = {};
    if (im.aov() != "color") return show_values([this] { return read_values(); }, im.aov(), settings, stats, scale);
    const size_t bytes = size_t(im.width) * im.height * 4;
    const std::shared_ptr<uint8_t> rgba = im.room(bytes);
    std::vector<std::vector<KernelTime>> times(im.shared->size());
    im.shared->read([&](size_t i, Frames& frames) {
        times[i].clear();
        frames.read_display(settings, rgba.get(), stats ? &times[i] : nullptr);
    });
    for (size_t i = 0; stats && i < times.size(); ++i) {
        merge_times(stats->kernels, times[i]);
        for (DeviceShare& share : stats->devices)
            if (share.id == im.shared->device(i)->info().id())
                for (const KernelTime& time : times[i]) {
                    double& ms = time.name == "tone map" ? share.tone_map_ms : share.read_ms;
                    ms = std::max(ms, time.ms);
                }
    }
    return {im.width, im.height, SharedBytes(rgba, bytes)};
}

PendingImage MultiFrames::begin_display(const Settings& settings) {
    return impl_->alone->begin_display(settings);
}

bool MultiFrames::copies_aside() const {
    return impl_->alone && impl_->alone->copies_aside();
}

}  // namespace clarity
