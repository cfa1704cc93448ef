// async_readback.hpp -- a picture that is being copied from a device to the host.
#pragma once
#include <CL/opencl.hpp>
#include <memory>
#include <vector>

#include "base/pictures/byte_image.hpp"
#include "device/device.hpp"
#include "device/kernel_time.hpp"

namespace clarity {

// The result of DisplayReadback. It may outlive the DisplayReadback, but not the device's being open. Used from one thread.
class AsyncReadback {
 public:
    AsyncReadback() = default;
    AsyncReadback(AsyncReadback&& other) = default;
    AsyncReadback& operator=(AsyncReadback&& other) noexcept;
    ~AsyncReadback() { settle(); }
    // Waits for the picture and returns it. Call it once. Throws Error(failed). If given, `times` gets those of tone mapping
    // and copy.
    ByteImage wait(std::vector<KernelTime>* times = nullptr);
    explicit operator bool() const { return memory_ != nullptr; }

 private:
    friend class DisplayReadback;
    void settle();
    size_t bytes() const { return size_t(width_) * height_ * 4; }

    std::shared_ptr<Device> device_;
    std::shared_ptr<uint8_t> memory_;  // the device writes to it
    cl::Buffer in_place_;              // on a CPU: the display buffer, which uses memory_
    unsigned width_ = 0, height_ = 0;
    cl::Event first_, last_;  // of the denoiser; empty: there was none
    cl::Event mapped_, copied_;
};

}  // namespace clarity
