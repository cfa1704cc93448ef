// replay.hpp -- the samples of one pixel of the tracer `path`, traced once more, with the paths that they took.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "launch/prepared.hpp"
#include "rt_types.h"
#include "tracers/replay/path_record.h"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {

// The random numbers of a pixel's samples, by their dimensions (cl/sampling/dimensions.h).
struct SamplerPoints {
    unsigned samples = 0, dimensions = 0;
    std::vector<float> values;  // of 0..1, those of a sample together
    float at(unsigned sample, unsigned dimension) const { return values[size_t(sample) * dimensions + dimension]; }
};

// What a dimension is for, by its number: "pixel x", "event 2, light u".
std::string dimension_name(unsigned dimension);

// A grid of as many cells as there are samples, or fewer: columns and rows are powers of two. The first two dimensions of a set
// of Sobol's points have one point in each, if their number is a power of two.
struct Strata {
    unsigned columns = 1, rows = 1;
    unsigned filled = 0;  // cells with a point in them
};
Strata strata_of(const SamplerPoints& points, unsigned across, unsigned up);

// All of it as text: a line of names, then one for each sample.
std::string points_csv(const SamplerPoints& points);

struct ReplayedSample {
    std::array<float, 3> light{};  // linear RGB
    size_t first_record = 0;       // in Replay::records
    unsigned records = 0;
};

struct Replay {
    std::vector<ReplayedSample> samples;  // in their order, from sample 0 on
    std::vector<rt_path_record> records;
    std::array<float, 3> mean{};  // bit for bit what the film has, if its samples are these
};

// Traces samples of single pixels and records their paths. Used from one thread at a time; a FrameRenderer may use the same
// device meanwhile.
class PathReplayer {
 public:
    explicit PathReplayer(std::shared_ptr<Device> device);
    ~PathReplayer();
    // Adds the samples [replay.samples.size(), + count) of pixel (x, y) of the film; y counts from the top. The samples of one
    // replay may be traced in several calls, each with what is prepared for them, as motion blur needs it. The first call for a
    // program compiles a variant of it. Throws Error(usage) for a pixel outside the picture, Error(kernel_build_failed),
    // Error(failed), and Cancelled.
    void trace(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y, unsigned count,
               Progress& progress, Replay& replay);
    // The random numbers of the first `count` samples of a pixel, of its camera ray and of `events` events. Throws as trace().
    SamplerPoints points(const Prepared& prepared, const Settings& settings, const View& view, unsigned x, unsigned y,
                         unsigned count, unsigned events, Progress& progress);

 private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace clarity
