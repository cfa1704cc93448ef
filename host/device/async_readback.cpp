#include "device/async_readback.hpp"

#include <utility>

#include "device/cl_errors.hpp"
#include "device/launch_limit.hpp"

namespace clarity {

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
