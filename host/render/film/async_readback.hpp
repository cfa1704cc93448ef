// async_readback.hpp -- a picture on its way from a device to the host.
#pragma once
#include <CL/opencl.hpp>
#include <memory>
#include <vector>

#include "device/device.hpp"
#include "render/film/byte_image.hpp"

namespace clarity {

struct KernelTime;

// May outlive who made it, though not the device's being open.
class AsyncReadback {
 public:
    AsyncReadback() = default;
    AsyncReadback(AsyncReadback&& other) = default;
    AsyncReadback& operator=(AsyncReadback&& other) noexcept;
    ~AsyncReadback() { settle(); }
    // Waits for it; once. Throws Error(failed). times: where given, gains those of tones and copy.
    ByteImage wait(std::vector<KernelTime>* times = nullptr);
    explicit operator bool() const { return memory_ != nullptr; }

 private:
    friend class DisplayReadback;
    void settle();
    size_t bytes() const { return size_t(width_) * height_ * 4; }

    std::shared_ptr<Device> device_;
    std::shared_ptr<uint8_t> memory_;  // that the device writes to
    cl::Buffer in_place_;              // a CPU's display, which is that memory
    unsigned width_ = 0, height_ = 0;
    cl::Event mapped_, copied_;
};

}  // namespace clarity
