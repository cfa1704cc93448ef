// display_readback.hpp -- pictures from a film to the host, one by one or each copied while the next one is traced.
//
// A queue does one thing after the other, so copies beside it have one of their own, which waits for a picture's tones by an
// event. Displays are double; the memory of the host that they are copied to goes with the picture.
#pragma once
#include <memory>

#include "render/film/async_readback.hpp"
#include "render/film/film.hpp"
#include "render/film/growing_buffer.hpp"
#include "render/film/pinned_memory_pool.hpp"

namespace clarity {

// A film of colours.
struct ColorFilm {
    const cl::Buffer& sums;  // of samples: room(pixels) float4
    unsigned width, height;
};

class DisplayReadback {
 public:
    DisplayReadback(std::shared_ptr<Device> device, FilmKernels& kernels)
        : device_(std::move(device)), kernels_(kernels), memory_(device_) {}
    // The film's picture. aside: its copy holds up nothing that is queued later.
    AsyncReadback take(const ColorFilm& film, const Settings& settings, bool aside);
    // Begins with that, behind what is queued: take() of the same film with the same settings then finds it under way. Returns
    // the last event in the device's own queue.
    cl::Event begin(const ColorFilm& film, const Settings& settings, bool aside);
    // The film is about to be another.
    void forget_begun() { begun_ = {}; }

 private:
    struct Display {
        GrowingBuffer buffer{CL_MEM_WRITE_ONLY};
        cl::Event copied;
    };
    std::shared_ptr<Device> device_, copies_;  // the same by a queue of its own
    FilmKernels& kernels_;
    PinnedMemoryPool memory_;
    Display displays_[2];
    unsigned turn_ = 0;
    AsyncReadback begun_;
    Tones tones_;  // of what is begun
};

}  // namespace clarity
