// film.hpp -- kernels after tracing: sums over counters, tones for a screen.
#pragma once
#include <functional>
#include <memory>

#include "render/film/bands.hpp"
#include "render/film/growing_buffer.hpp"
#include "render/film/pinned_memory_pool.hpp"
#include "render/frame/renderer.hpp"

namespace clarity {

// Reads what is no colour and paints it in false ones. stats, scale: where given, gain the times and what the colours mean.
ByteImage show_values(const std::function<FloatImage()>& read, const std::string& aov, const Settings& settings,
                      FrameStats* stats, FalseColorScale* scale);

// What a film of colours is shown with.
struct Tones {
    double exposure = 0;
    std::string tone;
    Tones() = default;
    explicit Tones(const Settings& settings) : exposure(settings.exposure), tone(settings.tone) {}
    bool operator==(const Tones& other) const { return exposure == other.exposure && tone == other.tone; }
};

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
    ~FilmKernels();
    // The width of each of the four numbers that are counted: 32 bits of a packet (trace_iterative), 64 bits of all that a
    // work-group has traced (trace_wavefront).
    enum class CounterWidth { bits32, bits64 };
    // Enqueues sums over so many counters of four numbers each; returns the last event. The sums have 64 bits.
    cl::Event begin_sum(const cl::Buffer& counters, unsigned count, CounterWidth width);
    // Waits for them.
    RayCounts end_sum(KernelTime& time);
    // Enqueues the tones of a film, room(pixels) float4, sums of samples, into a display of room(pixels) * 4 bytes.
    cl::Event map_tones(const cl::Buffer& film, const cl::Buffer& display, size_t pixels, const Settings& settings);
    // Enqueues adding layers (rt_types.h) to these rows of the film. adds: 0: anew.
    cl::Event add_layers(const cl::Buffer& film, const cl::Buffer& layers, unsigned count, bool adds, const GroupRows& rows);
    // Enqueues the tones of these rows alone, each to its place in the picture: rgba, 4 * pixels bytes. Returns the last event.
    cl::Event begin_rows(const cl::Buffer& film, const GroupRows& rows, const Settings& settings, uint8_t* rgba);
    // Waits for them and adds what they took.
    void end_rows(std::vector<KernelTime>& times);

 private:
    // Arguments that both kernels have.
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
