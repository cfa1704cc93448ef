// render_stats.hpp -- statistics of `clarity render --stats`.
#pragma once
#include <string>
#include <vector>

#include "render/frame/frame_stats.hpp"
#include "render/multi/multi_preparer.hpp"

namespace clarity {

// One of several processes that share pictures (--mpi).
struct RankTimes {
    double frame_ms = 0, wall_ms = 0;  // of its part of a frame, medians: by the clock of its devices, of its host
};

struct RenderStats {
    std::vector<std::string> files;
    std::vector<DeviceInfo> devices;
    std::vector<DeviceShare> shares;  // of the last frame, if several devices shared it
    std::shared_ptr<const Prepared> prepared;
    Settings settings;
    double import_ms = 0;
    double first_picture_ms = 0;            // from the start of the command until the first picture is in memory
    std::vector<double> frame_ms, wall_ms;  // one entry per timed frame with all its samples: device clock, host clock
    std::vector<RankTimes> ranks;           // empty: one process renders
    double collect_ms = 0;                  // from the moment that all ranks are done until the first one has the last picture
    uint64_t primary = 0, shadow = 0, secondary = 0, dropped = 0, overflowed = 0;  // of one frame
};

// The statistics as JSON, which ends in a newline. Its keys never change; new ones may come.
std::string stats_json(const RenderStats& stats);
// Median of frame_ms; 0 if nothing was timed.
double median_frame_ms(const RenderStats& stats);
// Million rays a second: all rays of a frame by its median time; 0 if nothing was timed.
double mrays_per_s(const RenderStats& stats);

}  // namespace clarity
