// multi_device_film.hpp -- a picture in the films of several devices: which device traces which tiles, and what happens if one
// fails.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/error.hpp"
#include "frames/frame_renderer.hpp"
#include "stand/device_threads.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "stand/multi_preparer.hpp"
#include "stand/ranks.hpp"
#include "stand/tile_scheduler.hpp"

namespace clarity {

// Used from one thread. A device that fails takes no further part. Functions throw its error when no device is left.
class MultiDeviceFilm {
 public:
    // ranks: other processes, each of which traces a part of the picture; nullptr: none. Must outlive this object. Throws what
    // FrameRenderer's constructor throws if no device can hold a film.
    explicit MultiDeviceFilm(const Devices& devices, Ranks* ranks = nullptr);

    // Traces samples [sample, end): see MultiFrameRenderer::trace(). display: RGBA8 of the whole picture; if not null, each
    // device copies its displayed rows there as soon as it is done.
    FrameStats trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings, const View& view,
                     unsigned sample, unsigned end, bool count_rays, Progress& progress, uint8_t* display = nullptr);
    // The next picture begins with these sums of `samples` samples (FrameRenderer::read_sums()): the next trace() starts with
    // sample `samples` and deals all tiles anew.
    void resume(std::shared_ptr<const FloatImage> sums, unsigned samples);
    // Whether every device has copied all of its rows to `display`. If so, each device's `times` get those of this work.
    bool displayed(std::vector<std::vector<KernelTime>>& times) const;
    // The number of samples that all devices have completed.
    unsigned samples() const;
    // Calls work(i, renderer of device i) in parallel for each device that has tiles. Repeats after a failure, until all tiles
    // are read.
    void read(const std::function<void(size_t, FrameRenderer&)>& work);

    // The rows of the picture that this process traces: all, without other ranks.
    std::vector<PixelRows> rows() const;

    size_t size() const { return members_.size(); }
    const std::shared_ptr<Device>& device(size_t i) const { return members_[i].device; }
    bool works(size_t i) const { return members_[i].works(); }

 private:
    // One device and its part of the picture.
    struct Member {
        std::shared_ptr<Device> device;
        std::unique_ptr<FrameRenderer> frames;     // null: the device failed
        std::shared_ptr<const Prepared> prepared;  // null: the device takes no part
        std::vector<unsigned> tiles;
        SharedRows rows;  // work-group rows of these tiles
        unsigned rows_in_tile = 1, rows_in_picture = 1;
        unsigned samples = 0;  // completed for all its tiles
        FrameStats stats;      // of the last trace()
        double wall_ms = 0;
        bool displayed = false;
        bool works() const { return frames && prepared; }
    };
    // The arguments of trace(), and its start time.
    struct Batch {
        std::chrono::steady_clock::time_point begin;
        unsigned sample, end;
        bool fresh;
        uint8_t* display;
    };
    // What the films hold before the first sample that is traced here.
    struct Start {
        std::shared_ptr<const FloatImage> sums;  // null: nothing
        unsigned samples = 0;
        bool is_new = false;  // no sample after it has been traced
    };
    void cut();
    void take_tiles();
    bool may_be_alone() const;
    void choose_alone();
    double greatest_share() const;
    bool deal_by_speed(unsigned end, double device_ms);
    bool goes_on(const MultiPrepared& prepared, const Settings& settings);
    void give(Member& member, const std::vector<unsigned>& tiles);
    void put_start(Member& member);
    double trace_rows(Member& member, const Samples& samples, bool count_rays, Progress& progress, uint8_t* display = nullptr);
    void trace_part(size_t index, const Batch& batch, bool count_rays, Progress& progress);
    std::vector<std::vector<unsigned>> orphans() const;
    void recover(Progress& progress);
    void on_all(const std::function<void(size_t)>& work);
    void fail(Member& member, const Error& error);
    size_t working() const;
    FrameStats gathered(double wall_ms) const;

    std::vector<Member> members_;
    std::unique_ptr<TileScheduler> scheduler_;
    TeamChoice team_;
    std::optional<size_t> alone_;  // the device that traces the picture without the others
    // The picture in the films.
    std::shared_ptr<const MultiPrepared> prepared_;
    Settings settings_;
    View view_;
    Start start_;
    unsigned tile_count_ = 0, tile_height_ = 1;
    std::vector<unsigned> tiles_;  // of this process; ascending
    Ranks* const ranks_;
    std::vector<double> rank_speeds_;  // tiles a millisecond, of each rank; empty: not known
    Error last_failure_{Exit::failed, "no device takes part"};
    std::unique_ptr<DeviceThreads> threads_;  // last, so that the threads end first
};

}  // namespace clarity
