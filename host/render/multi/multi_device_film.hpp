// multi_device_film.hpp -- a picture in the films of several devices: whose strips are whose, and what to do if one fails.
#pragma once
#include <chrono>
#include <functional>
#include <memory>
#include <vector>

#include "base/error.hpp"
#include "render/multi/device_threads.hpp"
#include "render/multi/multi_preparer.hpp"
#include "render/multi/tile_scheduler.hpp"

namespace clarity {

// Used from one thread. Devices that fail are out for good; functions throw when none is left.
class MultiDeviceFilm {
 public:
    // Throws what Frames throws, if no device can hold a film.
    explicit MultiDeviceFilm(const Devices& devices);

    // Samples [sample, end). See MultiFrameRenderer::trace(). display: where devices are to bring what is shown of them as soon
    // as they have it.
    FrameStats trace(const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings, const View& view,
                     unsigned sample, unsigned end, bool count_rays, Progress& progress, uint8_t* display = nullptr);
    // Whether they did, with all of the picture; times: of each device, gain what that took.
    bool displayed(std::vector<std::vector<KernelTime>>& times) const;
    // That are complete everywhere.
    unsigned samples() const;
    // work(i, frames of device i) on each that has something of the picture, until all of it is done.
    void read(const std::function<void(size_t, FrameRenderer&)>& work);

    size_t size() const { return members_.size(); }
    const std::shared_ptr<Device>& device(size_t i) const { return members_[i].device; }
    bool works(size_t i) const { return members_[i].works(); }

 private:
    struct Member {
        std::shared_ptr<Device> device;
        std::unique_ptr<FrameRenderer> frames;     // null: it failed
        std::shared_ptr<const Prepared> prepared;  // null: it takes no part
        std::vector<unsigned> tiles;
        SharedRows rows;  // of work-groups, of these strips
        unsigned rows_in_tile = 1, rows_in_picture = 1;
        unsigned samples = 0;  // complete, of all its strips
        FrameStats stats;      // of the last trace()
        double wall_ms = 0;
        bool displayed = false;
        bool works() const { return frames && prepared; }
    };
    // What trace() is to do, and since when.
    struct Batch {
        std::chrono::steady_clock::time_point begin;
        unsigned sample, end;
        bool fresh;
        uint8_t* display;
    };
    void cut();
    bool goes_on(const MultiPrepared& prepared, const Settings& settings);
    void give(Member& member, const std::vector<unsigned>& tiles);
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
    // What is in the films.
    std::shared_ptr<const MultiPrepared> prepared_;
    Settings settings_;
    View view_;
    unsigned tile_count_ = 0;
    Error last_failure_{Exit::failed, "no device takes part"};
    std::unique_ptr<DeviceThreads> threads_;  // last: they go first
};

}  // namespace clarity
