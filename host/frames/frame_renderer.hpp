// frame_renderer.hpp -- from a Prepared and a view to a picture. preparer.hpp does the slow work before.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/pictures/image_io.hpp"
#include "base/progress.hpp"
#include "device/device.hpp"
#include "launch/prepared.hpp"
#include "picture/display_readback.hpp"
#include "picture/frame_stats.hpp"
#include "view/settings/false_color_scale.hpp"
#include "view/view.hpp"

namespace clarity {

// The rows of work-groups that one device traces of a shared picture, in the order in which the scheduler assigned them. A
// sample may take several calls while rows are assigned. Rows before `begin` are already traced.
struct SharedRows {
    std::vector<rt_u32> rows;
    size_t begin = 0;
    // If set, trace() copies the displayed rows to this picture behind the last sample, as read_display() does.
    uint8_t* display = nullptr;
};

// Consecutive samples of a picture. Sample 0 replaces what is in the film; sample n is added to those before it.
struct Samples {
    Samples(unsigned first_sample, unsigned how_many = 1, std::function<bool(unsigned)> told = {})
        : first(first_sample), count(how_many), complete(std::move(told)) {}
    unsigned first, count;
    // If set, called from time to time with the number of samples in the film. Returning false stops the trace.
    std::function<bool(unsigned)> complete;
};

// Traces pictures on one device and owns their film. Used from one thread.
class FrameRenderer {
 public:
    explicit FrameRenderer(std::shared_ptr<Device> device);
    ~FrameRenderer();

    // Traces samples into the film. Width, height, depth, shadows and other settings that need no rebuild come from `settings`;
    // everything else comes from `prepared`. The work is cut into launches of less than half a second; a launch may hold
    // several short samples. `progress` is asked between launches. Throws Error(failed), and Cancelled after a cancel.
    // shared: the rows to trace; null traces all. The read functions below then return these rows only.
    // meanwhile: called once while the device is busy. Use it to wait for the previous picture.
    FrameStats trace(const Prepared& prepared, const Settings& settings, const View& view, const Samples& samples,
                     bool count_rays, Progress& progress, const SharedRows* shared = nullptr,
                     const std::function<void()>& meanwhile = {});
    // Writes the ray counts and full stacks of the last sample to `stats`, as trace() does with count_rays.
    void count(FrameStats& stats);

    // Returns the mean of the film's samples: 3 channels for color, normal and uv, else 1. prim and instance are numbers; -1:
    // no hit.
    FloatImage read_values();
    // The same as it is written to files: without its noise, if the settings say so and the film has what that takes.
    FloatImage read_picture(const Settings& settings);
    // Returns the distance along the camera ray of sample 0 of the last picture: 1 channel, +inf where nothing was hit. Empty
    // for AOVs of camera rays other than `t`, because their programs do not store it.
    FloatImage read_distance();
    // These two write the traced rows into an image of the whole picture, which other devices fill too. read_distance() returns
    // false if the distance is not known.
    void read_values(FloatImage& image);
    bool read_distance(FloatImage& image);
    // The film as it is, for checkpoints of colours: 4 channels, sums of r, g and b and the number of samples; where the film
    // has more planes (film_planes()), the rows of each follow those of the one before. read_sums()
    // writes the traced rows into an image of the whole picture, of as many planes as it has room for. write_sums() puts rows
    // back, those of `shared` from its `begin` on, so that trace() goes on with the sample after them. The arguments are those
    // of that trace().
    void read_sums(FloatImage& image);
    void write_sums(const Prepared& prepared, const Settings& settings, const FloatImage& sums,
                    const SharedRows* shared = nullptr);
    // Writes the traced rows into a picture of the whole size: RGBA8, top row first. Only for colours.
    void read_display(const Settings& settings, uint8_t* rgba, std::vector<KernelTime>& times);
    // Appends the times of that work if trace() did it (SharedRows::display).
    void add_display_times(std::vector<KernelTime>& times);
    // Returns the picture as sRGB: colours tone-mapped, other AOVs in false colours. If given, `stats` gets the times of this
    // work and `scale` the scale of the false colours.
    ByteImage read_display(const Settings& settings, FrameStats* stats = nullptr, FalseColorScale* scale = nullptr);
    // The same for colours, without waiting for the copy. The next picture may be traced before this one is waited for. This is
    // faster only if overlaps_copies(), because the copy then runs while the device traces.
    AsyncReadback begin_display(const Settings& settings);
    bool overlaps_copies() const;

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
