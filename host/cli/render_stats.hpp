// render_stats.hpp -- what `clarity render --stats` reports.
#pragma once
#include <string>
#include <vector>

#include "render/multi/multi_preparer.hpp"

namespace clarity {

struct RenderStats {
    std::vector<std::string> files;
    std::vector<DeviceInfo> devices;
    std::vector<DeviceShare> shares;  // of the last frame, where several devices shared it
    std::shared_ptr<const Prepared> prepared;
    Settings settings;
    double import_ms = 0;
    double first_picture_ms = 0;            // from the start of the command to the first picture in memory
    std::vector<double> frame_ms, wall_ms;  // one a timed frame, all its samples: by the device's clock, by the host's
    uint64_t primary = 0, shadow = 0, secondary = 0, dropped = 0, overflowed = 0;  // of one frame
};

// The JSON of DESIGN.md section 5, ends in a newline.
std::string stats_json(const RenderStats& stats);
// 0 if nothing was timed.
double median_frame_ms(const RenderStats& stats);
// All rays of a frame by its median time, in millions a second; 0 if nothing was timed.
double mrays_per_s(const RenderStats& stats);

}  // namespace clarity
