// film.hpp -- kernels after tracing: sums over counters, tones for a screen.
#pragma once
#include <functional>
#include <memory>

#include "render/growing_buffer.hpp"
#include "render/host_picture.hpp"
#include "render/renderer.hpp"

namespace clarity {

// Floats a pixel: in the film, and in a picture of its values.
inline unsigned film_channels(const std::string& aov) {
    if (aov == "color") return 4;
    return aov == "normal" || aov == "uv" ? 3 : 1;
}
inline unsigned value_channels(const std::string& aov) {
    return aov == "color" ? 3 : film_channels(aov);
}

// Reads what is no colour and paints it in false ones. stats: where given, gains the times.
FalseColorScale show_values(const std::function<FloatImage()>& read, const std::string& aov, const Settings& settings,
                            uint8_t* rgba, FrameStats* stats);

struct RayCounts {
    uint64_t shadow = 0, secondary = 0, dropped = 0, overflowed = 0;
};

class FilmKernels {
 public:
    // The film is read and the display written by whole vectors of this many pixels, so both have room for them.
    static constexpr size_t kPixelsAtOnce = 4;
    static size_t room(size_t pixels) { return (pixels + kPixelsAtOnce - 1) / kPixelsAtOnce * kPixelsAtOnce; }

    // Throws Error(kernel_build_failed).
    explicit FilmKernels(std::shared_ptr<Device> device);
    // counters: of so many packets, as trace_iterative leaves them.
    RayCounts sum(const cl::Buffer& counters, unsigned packets, KernelTime& time);
    // film: room(pixels) float4, sums of samples. rgba: 4 * pixels bytes. Adds its times.
    void show(const cl::Buffer& film, size_t pixels, const Settings& settings, uint8_t* rgba, std::vector<KernelTime>* times);
    // Of some rows of work-groups alone, `row_height` pixels high, each to its place in the picture.
    void show_rows(const cl::Buffer& film, unsigned width, unsigned height, const std::vector<rt_u32>& rows,
                   unsigned row_height, const Settings& settings, uint8_t* rgba, std::vector<KernelTime>* times);
    // The same in memory of the device's own, which stays until the next call of either or of begin_to_show().
    const uint8_t* show(const cl::Buffer& film, size_t pixels, const Settings& settings, std::vector<KernelTime>* times);
    // Enqueues what the last show() does, behind what is queued; a show() of the same film with the same settings then finds it
    // done. Returns its last event. Not for a CPU.
    cl::Event begin_to_show(const cl::Buffer& film, size_t pixels, const Settings& settings);
    // The film is about to be another.
    void forget_shown() { begun_ = {}; }
    // Tones alone, into a display of room(pixels) * 4 bytes.
    cl::Event map_tones(const cl::Buffer& film, const cl::Buffer& display, size_t pixels, const Settings& settings);

 private:
    struct Begun {
        size_t pixels = 0;
        double exposure = 0;
        std::string tone;
        cl::Event mapped, read;
        const uint8_t* rgba = nullptr;  // null: nothing is begun
    };
    cl::Event map_tones(const cl::Buffer& film, size_t pixels, const Settings& settings);
    // Arguments that both kernels have.
    static void set_map(cl::Kernel& kernel, const cl::Buffer& film, const cl::Buffer& display, size_t pixels,
                        const Settings& settings);
    const cl::Buffer& own_display(size_t pixels);
    cl::Event run(const cl::Kernel& kernel, size_t items);

    std::shared_ptr<Device> device_;
    cl::Program program_;
    cl::Kernel map_tones_, map_tones_of_rows_, sum_counters_;
    GrowingBuffer display_{CL_MEM_WRITE_ONLY | CL_MEM_ALLOC_HOST_PTR}, sums_{CL_MEM_READ_WRITE}, rows_{CL_MEM_READ_ONLY};
    std::vector<rt_u32> rows_written_;
    HostPicture picture_;  // goes before what it shows
    Begun begun_;
};

}  // namespace clarity
