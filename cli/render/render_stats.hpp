// render_stats.hpp -- statistics of `clarity render --stats`.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "picture/film_noise.hpp"
#include "picture/frame_stats.hpp"
#include "stand/multi_preparer.hpp"
#include "stand/ranks.hpp"
#include "tools/compare/picture_errors.hpp"
#include "view/settings/settings.hpp"

namespace clarity {

// How the error of a picture against a reference falls while its samples are traced (--reference).
class MultiFrameRenderer;

class ReferenceRun {
 public:
    // Reads the reference. settings: must outlive this. Throws Error(failed); with a size that is not the picture's,
    // Error(usage).
    ReferenceRun(const std::string& file, const Settings& settings);

    struct Point {
        unsigned samples;
        PictureErrors errors;
    };
    // Begins a picture anew.
    void begin() { points_.clear(); }
    // Compares the picture so far, if it has twice the samples of the last comparison, or is finished.
    void offer(MultiFrameRenderer& frames, unsigned samples, bool finished);
    const std::vector<Point>& points() const { return points_; }
    const std::string& file() const { return file_; }
    double slope() const;

 private:
    const Settings& settings_;
    std::string file_;
    FloatImage reference_;
    std::vector<Point> points_;
};

// One of several processes that share pictures (--mpi).
struct RankTimes {
    double prepare_ms = 0;             // until it had structure, buffers and program
    double frame_ms = 0, wall_ms = 0;  // of its part of a frame, medians: by the clock of its devices, of its host
};

// Of the pixels of an AOV that tells what they cost.
struct PictureCost {
    double mean = 0, greatest = 0;
};

struct RenderStats : RayCounts {  // of one frame
    std::vector<std::string> files;
    std::vector<DeviceInfo> devices;
    std::vector<DeviceShare> shares;  // of the last frame, if several devices shared it
    std::shared_ptr<const Prepared> prepared;
    Settings settings;
    double import_ms = 0;
    double first_picture_ms = 0;            // from the start of the command until the first picture is in memory
    std::vector<double> frame_ms, wall_ms;  // one entry per timed frame with all its samples: device clock, host clock
    double prepare_ms = 0;                  // of structure, buffers and program together
    // Of several ranks; times are those of the first one. share_ms: from the end of the import until all had the scene.
    // wait_to_trace_ms: until the others could trace, too; wait_traced_ms: until they had traced the last picture. collect_ms:
    // from then on until the first one had the picture.
    std::vector<RankTimes> ranks;  // empty: one process renders
    double share_ms = 0, wait_to_trace_ms = 0, wait_traced_ms = 0, collect_ms = 0;
    std::shared_ptr<ReferenceRun> reference;  // null: there is none to compare with
    unsigned samples = 0;                     // of a pixel of the last picture
    std::optional<FilmNoise> noise;           // of the last picture, if `path` has traced it
    std::optional<PictureCost> cost;          // of the last picture, if it shows that
};

// Waits until all ranks can trace, so that this wait is no part of a picture's time, and fills in stats.ranks.
void gather_prepare_times(RenderStats& stats, Ranks& ranks);
// Waits until all ranks have traced their parts, and fills in their times; rays become those of all.
void gather_frame_times(RenderStats& stats, Ranks& ranks);
PictureCost cost_of(const FloatImage& values);
// The statistics as JSON, which ends in a newline. Its keys never change; new ones may come.
std::string stats_json(const RenderStats& stats);
// Median of frame_ms; 0 if nothing was timed.
double median_frame_ms(const RenderStats& stats);
// Million rays a second: all rays of a frame by its median time; 0 if nothing was timed.
double mrays_per_s(const RenderStats& stats);

}  // namespace clarity
