#include "render/pending_image.hpp"

#include <utility>

#include "render/guarded.hpp"
#include "render/renderer.hpp"

namespace clarity {

PendingImage& PendingImage::operator=(PendingImage&& other) noexcept {
    settle();
    device_ = std::move(other.device_);
    memory_ = std::move(other.memory_);
    in_place_ = std::move(other.in_place_);
    width_ = other.width_;
    height_ = other.height_;
    mapped_ = std::move(other.mapped_);
    copied_ = std::move(other.copied_);
    return *this;
}

// Memory that a device may still write to is not given back. What became of the picture is of no interest.
void PendingImage::settle() {
    const cl::Event& last = copied_() ? copied_ : mapped_;
    if (memory_ && last()) clWaitForEvents(1, &last());
    memory_.reset();
}

ByteImage PendingImage::wait(std::vector<KernelTime>* times) {
    guarded(*device_, "reading the picture", [&] {
        if (in_place_()) {
            cl::CommandQueue& queue = device_->queue();
            void* const seen = queue.enqueueMapBuffer(in_place_, CL_TRUE, CL_MAP_READ, 0, bytes(), nullptr, &copied_);
            queue.enqueueUnmapMemObject(in_place_, seen);
        } else {
            copied_.wait();
        }
    });
    if (times) {
        times->push_back({"tone map", event_ms(mapped_)});
        times->push_back({"read-back", event_ms(copied_)});
    }
    return {width_, height_, SharedBytes(std::move(memory_), bytes())};
}

}  // namespace clarity
