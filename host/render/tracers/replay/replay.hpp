// replay.hpp -- the samples of one pixel of the tracer `path`, traced once more, with the paths that they took.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "render/launch/prepared.hpp"
#include "render/settings/settings.hpp"
#include "render/tracers/replay/sampler_points.hpp"
#include "render/view/view.hpp"
#include "rt_types.h"
#include "tracers/replay/path_record.h"

namespace clarity {

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
