// display_readback.hpp -- copies pictures from a film to the host.
//
// A picture may be copied while the next one is traced. A command queue runs one command after the other, so these copies have
// a queue of their own, which waits for the end of tone mapping by an event. There are two display buffers, used alternately.
// The host memory of the copy belongs to the picture.
#pragma once
#include <CL/opencl.hpp>
#include <functional>
#include <memory>
#include <vector>

#include "base/pictures/byte_image.hpp"
#include "device/device.hpp"
#include "device/growing_buffer.hpp"
#include "device/kernel_time.hpp"
#include "picture/film.hpp"
#include "picture/pinned_memory_pool.hpp"

namespace clarity {

// A picture that is being copied from a device to the host.

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

// A film of colours. `sums` holds the sums of samples: FilmKernels::room(pixels) float4. first, last: the commands that have
// made it of another one, for their time; empty: none.
struct ColorFilm {
    const cl::Buffer& sums;
    unsigned width, height;
    cl::Event first = {}, last = {};
};

// Tone-maps a film and copies the result. Used from one thread.
class DisplayReadback {
 public:
    DisplayReadback(std::shared_ptr<Device> device, FilmKernels& kernels)
        : device_(std::move(device)), kernels_(kernels), memory_(device_) {}
    // Returns the film's picture, which may still be on its way. film: called unless begin() was. overlapped: the copy does not
    // delay work that is queued later.
    AsyncReadback take(const std::function<ColorFilm()>& film, const Settings& settings, bool overlapped);
    // Starts this work behind the commands that are queued. A later take() of the same film with the same settings returns the
    // picture begun here. Returns the last event in the device's own queue.
    cl::Event begin(const ColorFilm& film, const Settings& settings, bool overlapped);
    // Call this when the film is about to change: take() then ignores the picture that was begun.
    void forget_begun() { begun_ = {}; }

 private:
    struct Display {
        GrowingBuffer buffer{CL_MEM_WRITE_ONLY};
        cl::Event copied;
    };
    std::shared_ptr<Device> device_, copies_;  // copies_: the same device with a queue of its own
    FilmKernels& kernels_;
    PinnedMemoryPool memory_;
    Display displays_[2];
    // Index of the display buffer that was used last.
    unsigned parity_ = 0;
    AsyncReadback begun_;
    Tones tones_;  // of begun_
};

}  // namespace clarity
