// display_relay.hpp -- picture after picture on its way to the host: each is copied while the next one is traced.
//
// A queue does one thing after the other, so copies have one of their own, which waits for a picture's tones by an event.
// Displays and memory of the host are double. It is worth what the copy takes, at the price of one picture's delay.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "render/film.hpp"
#include "render/growing_buffer.hpp"
#include "render/host_picture.hpp"

namespace clarity {

class DisplayRelay {
 public:
    explicit DisplayRelay(std::shared_ptr<Device> device) : device_(std::move(device)) {}
    // Enqueues tones and copy of the film behind what is queued. Returns the event of its tones.
    cl::Event begin(FilmKernels& kernels, const cl::Buffer& film, size_t pixels, const Settings& settings);
    // The film is about to be another.
    void forget_begun() { begun_ = false; }
    // Hands in the film, begun or not, and gives what was handed in before: null the first time. It stays until the next
    // begin().
    const uint8_t* exchange(FilmKernels& kernels, const cl::Buffer& film, size_t pixels, const Settings& settings,
                            std::vector<KernelTime>* times);
    // What was handed in last; null if nothing was since.
    const uint8_t* last(std::vector<KernelTime>* times);

 private:
    struct Slot {
        GrowingBuffer display{CL_MEM_WRITE_ONLY | CL_MEM_ALLOC_HOST_PTR};
        std::unique_ptr<HostPicture> picture;  // goes before what it shows
        size_t pixels = 0;
        double exposure = 0;
        std::string tone;
        cl::Event mapped, read;
        const uint8_t* rgba = nullptr;  // of a CPU: not looked at yet
        bool filled = false;
    };
    const uint8_t* finish(Slot& slot, std::vector<KernelTime>* times);

    std::shared_ptr<Device> device_, copies_;  // the same by a queue of its own
    Slot slots_[2];
    unsigned at_ = 0;     // where the film goes, by turns
    bool begun_ = false;  // it is there
};

}  // namespace clarity
