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

AsyncReadback& AsyncReadback::operator=(AsyncReadback&& other) noexcept {
    settle();
    device_ = std::move(other.device_);
    memory_ = std::move(other.memory_);
    in_place_ = std::move(other.in_place_);
    width_ = other.width_;
    height_ = other.height_;
    first_ = std::move(other.first_);
    last_ = std::move(other.last_);
    mapped_ = std::move(other.mapped_);
    copied_ = std::move(other.copied_);
    return *this;
}

// A device may still be writing to the memory, so wait before giving it back. Whether the picture succeeded no longer matters.
void AsyncReadback::settle() {
    const cl::Event& last = copied_() ? copied_ : mapped_;
    if (memory_ && last()) {
        if (device_->loss()->stuck())
            never_release(memory_);
        else
            clWaitForEvents(1, &last());
    }
    memory_.reset();
}

ByteImage AsyncReadback::wait(std::vector<KernelTime>* times) {
    wrap_cl_errors(*device_, "reading the picture", [&] {
        if (in_place_()) {
            Queue& queue = device_->queue();
            void* const seen = queue.enqueueMapBuffer(in_place_, CL_TRUE, CL_MAP_READ, 0, bytes(), nullptr, &copied_);
            queue.enqueueUnmapMemObject(in_place_, seen);
        } else {
            wait_for(*device_, copied_, "tone mapping");
        }
    });
    if (times) {
        if (last_()) times->push_back({"denoise", span_ms(first_, last_)});
        times->push_back({"tone map", event_ms(mapped_)});
        times->push_back({"read-back", event_ms(copied_)});
    }
    return {width_, height_, SharedBytes(std::move(memory_), bytes())};
}

}  // namespace clarity
