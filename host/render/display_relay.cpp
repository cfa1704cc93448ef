#include "render/display_relay.hpp"

#include <utility>

#include "render/guarded.hpp"

namespace clarity {

cl::Event DisplayRelay::begin(FilmKernels& kernels, const cl::Buffer& film, size_t pixels, const Settings& settings) {
    const bool cpu = device_->info().cpu;
    if (!copies_) copies_ = cpu ? device_ : device_->with_own_queue();
    Slot& slot = slots_[at_];
    begun_ = false;
    if (std::exchange(slot.filled, false) && !cpu) clWaitForEvents(1, &slot.read());  // whatever became of it
    if (!slot.picture) slot.picture = std::make_unique<HostPicture>(copies_);
    if (cpu) slot.picture->release();  // it is the display itself
    const cl::Buffer& display = slot.display.fit(device_->context(), FilmKernels::room(pixels) * 4);
    slot.mapped = kernels.map_tones(film, display, pixels, settings);
    slot.rgba = nullptr;
    if (!cpu) {
        slot.rgba = slot.picture->begin(display, pixels * 4, &slot.read, {slot.mapped});
        device_->queue().flush();  // or the other queue may wait for what is not on its way
        copies_->queue().flush();
    }
    slot.pixels = pixels;
    slot.exposure = settings.exposure;
    slot.tone = settings.tone;
    slot.filled = begun_ = true;
    return slot.mapped;
}

const uint8_t* DisplayRelay::exchange(FilmKernels& kernels, const cl::Buffer& film, size_t pixels, const Settings& settings,
                                      std::vector<KernelTime>* times) {
    const Slot& slot = slots_[at_];
    const bool same = slot.pixels == pixels && slot.exposure == settings.exposure && slot.tone == settings.tone;
    if (!begun_ || !same) begin(kernels, film, pixels, settings);
    begun_ = false;
    at_ ^= 1u;
    return finish(slots_[at_], times);
}

const uint8_t* DisplayRelay::last(std::vector<KernelTime>* times) {
    at_ ^= 1u;
    return finish(slots_[at_], times);
}

const uint8_t* DisplayRelay::finish(Slot& slot, std::vector<KernelTime>* times) {
    if (!std::exchange(slot.filled, false)) return nullptr;
    if (device_->info().cpu)
        slot.rgba = slot.picture->fetch(slot.display.get(), slot.pixels * 4, &slot.read);
    else
        slot.read.wait();
    if (times) {
        times->push_back({"tone map", event_ms(slot.mapped)});
        times->push_back({"read-back", event_ms(slot.read)});
    }
    return slot.rgba;
}

}  // namespace clarity
