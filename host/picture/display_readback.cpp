#include "picture/display_readback.hpp"

#include <utility>

#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"

namespace clarity {

cl::Event DisplayReadback::begin(const ColorFilm& film, const Settings& settings, bool overlapped) {
    begun_ = {};
    const size_t pixels = size_t(film.width) * film.height, room = FilmKernels::room(pixels) * 4;
    AsyncReadback image;
    image.device_ = device_;
    image.width_ = film.width;
    image.height_ = film.height;
    image.first_ = film.first;
    image.last_ = film.last;
    image.memory_ = memory_.lend(room);
    if (device_->info().cpu) {
        image.in_place_ = cl::Buffer(device_->context(), CL_MEM_WRITE_ONLY | CL_MEM_USE_HOST_PTR, room, image.memory_.get());
        image.mapped_ = kernels_.map_tones(film.sums, image.in_place_, pixels, settings);
    } else {
        Display& display = displays_[parity_ ^= 1u];
        if (display.copied())
            clWaitForEvents(1, &display.copied());  // complete since long; its own reader has reported any failure
        const cl::Buffer& tones = display.buffer.fit(device_->context(), room);
        image.mapped_ = kernels_.map_tones(film.sums, tones, pixels, settings);
        const std::vector<cl::Event> after = {image.mapped_};
        if (overlapped && !copies_) copies_ = device_->with_own_queue();
        Queue& copies = overlapped ? copies_->queue() : device_->queue();
        copies.enqueueReadBuffer(tones, CL_FALSE, 0, image.bytes(), image.memory_.get(), &after, &image.copied_);
        display.copied = image.copied_;
        device_->queue().flush();  // otherwise the other queue waits for commands that are not submitted
        copies.flush();
    }
    tones_ = Tones(settings);
    begun_ = std::move(image);
    return overlapped ? begun_.mapped_ : begun_.copied_;
}

AsyncReadback DisplayReadback::take(const std::function<ColorFilm()>& film, const Settings& settings, bool overlapped) {
    if (!begun_ || !(tones_ == Tones(settings))) begin(film(), settings, overlapped);
    return std::move(begun_);
}

}  // namespace clarity
