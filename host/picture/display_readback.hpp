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
#include "device/async_readback.hpp"
#include "device/device.hpp"
#include "device/growing_buffer.hpp"
#include "device/kernel_time.hpp"
#include "picture/film.hpp"
#include "picture/pinned_memory_pool.hpp"

namespace clarity {

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
