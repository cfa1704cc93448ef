// film.hpp -- kernels that run after tracing: sums of ray counters, tone mapping, sums of layers.
#pragma once
#include <array>
#include <functional>
#include <memory>

#include "base/pictures/byte_image.hpp"
#include "base/pictures/image_io.hpp"
#include "compile/compile.hpp"
#include "device/device.hpp"
#include "device/growing_buffer.hpp"
#include "device/kernel_time.hpp"
#include "picture/bands.hpp"
#include "picture/pinned_memory_pool.hpp"
#include "view/settings/false_color_scale.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

// Calls `read` and paints the result in false colours. If given, `times` gets the times of this
// work and `scale` the meaning of the colours.
ByteImage show_values(const std::function<FloatImage()>& read, const std::string& aov, const Settings& settings,
                      std::vector<KernelTime>* times, FalseColorScale* scale);

// The settings that a picture of colours depends on, besides its film.
struct Tones {
    double exposure = 0;
    std::string tone;
    bool denoised = false;
    Tones() = default;
    explicit Tones(const Settings& settings) : exposure(settings.exposure), tone(settings.tone), denoised(denoises(settings)) {}
    bool operator==(const Tones& other) const {
        return exposure == other.exposure && tone == other.tone && denoised == other.denoised;
    }
};

// The program of these kernels, for compile_ahead().
CompileRequest film_program();

// Owns these kernels and their buffers on one device. Used from one thread; the functions below may throw cl::Error.
class FilmKernels {
 public:
    // Kernels read the film and write the display in vectors of this many pixels, so both buffers are padded to whole vectors.
    static constexpr size_t kPixelsAtOnce = 4;
    static size_t room(size_t pixels) { return (pixels + kPixelsAtOnce - 1) / kPixelsAtOnce * kPixelsAtOnce; }

    // Throws Error(kernel_build_failed).
    explicit FilmKernels(std::shared_ptr<Device> device);
    ~FilmKernels();
    // The width of each of the four counters: 32 bits for a packet (trace_iterative), 64 bits for everything that a work-group
    // has traced (trace_wavefront).
    enum class CounterWidth { bits32, bits64 };
    // Enqueues 64-bit sums over `count` counters of four numbers each. Returns the last event.
    cl::Event begin_sum(const cl::Buffer& counters, unsigned count, CounterWidth width);
    // Waits for the sums and returns them; `time` becomes that of the kernel.
    std::array<uint64_t, 4> end_sum(KernelTime& time);
    // Enqueues tone mapping of a film (room(pixels) float4, sums of samples) into a display of room(pixels) * 4 bytes.
    cl::Event map_tones(const cl::Buffer& film, const cl::Buffer& display, size_t pixels, const Settings& settings);
    // Enqueues adding `count` layers (rt_types.h) to these rows of the film. adds: false replaces what is in the film.
    cl::Event add_layers(const cl::Buffer& film, const cl::Buffer& layers, unsigned count, bool adds, const GroupRows& rows);
    // Enqueues tone mapping of these rows and their copy into the whole picture: rgba, 4 * pixels bytes. Returns the last
    // event.
    cl::Event begin_rows(const cl::Buffer& film, const GroupRows& rows, const Settings& settings, uint8_t* rgba);
    // Waits for the rows and appends their times.
    void end_rows(std::vector<KernelTime>& times);

 private:
    // Sets the arguments that both tone-mapping kernels share.
    static void set_map(cl::Kernel& kernel, const cl::Buffer& film, const cl::Buffer& display, size_t pixels,
                        const Settings& settings);
    cl::Event run(const cl::Kernel& kernel, size_t items);
    const cl::Buffer& table_of(const std::vector<rt_u32>& rows);

    std::shared_ptr<Device> device_;
    cl::Program program_;
    cl::Kernel map_tones_, map_tones_of_rows_, sum_counters_, sum_wide_counters_, add_layers_;
    GrowingBuffer display_{CL_MEM_WRITE_ONLY}, sums_{CL_MEM_READ_WRITE}, rows_{CL_MEM_READ_ONLY};
    std::vector<rt_u32> rows_written_;
    PinnedMemoryPool memory_;
    std::shared_ptr<uint8_t> read_sums_;
    cl::Event summed_, sums_read_, rows_mapped_;
    std::vector<cl::Event> rows_read_;
};

}  // namespace clarity
