#include "render/host_picture.hpp"

namespace clarity {

void HostPicture::release() {
    if (!memory_) return;
    try {
        if (device_->is_open()) device_->queue().enqueueUnmapMemObject(mapped_, memory_);
    } catch (const cl::Error&) {  // the device is lost, and the memory with it
    }
    mapped_ = cl::Buffer();
    memory_ = nullptr;
    room_ = 0;
}

const uint8_t* HostPicture::fetch(const cl::Buffer& source, size_t bytes, cl::Event* done) {
    cl::CommandQueue& queue = device_->queue();
    if (device_->info().cpu) {
        release();
        memory_ = queue.enqueueMapBuffer(source, CL_TRUE, CL_MAP_READ, 0, bytes, nullptr, done);
        mapped_ = source;
    } else {
        queue.enqueueReadBuffer(source, CL_TRUE, 0, bytes, pinned(bytes), nullptr, done);
    }
    return static_cast<const uint8_t*>(memory_);
}

const uint8_t* HostPicture::begin(const cl::Buffer& source, size_t bytes, cl::Event* done,
                                  const std::vector<cl::Event>& after) {
    device_->queue().enqueueReadBuffer(source, CL_FALSE, 0, bytes, pinned(bytes), &after, done);
    return static_cast<const uint8_t*>(memory_);
}

uint8_t* HostPicture::pinned(size_t bytes) {
    if (bytes > room_) {
        release();
        cl::Buffer room(device_->context(), CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, bytes);
        memory_ = device_->queue().enqueueMapBuffer(room, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, bytes);
        mapped_ = room;
        room_ = bytes;
    }
    return static_cast<uint8_t*>(memory_);
}

}  // namespace clarity
