// frame_thread.hpp -- the thread that traces: takes the newest wish, leaves the newest picture.
//
// Where a device copies beside its tracing, the next picture is begun before the last one is copied, if there is a next one to
// trace: pictures come as soon as they would otherwise, and more of them.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "render/film/false_colors.hpp"
#include "render/multi/multi_frame_renderer.hpp"
#include "ui/session/prepare_worker.hpp"

namespace clarity::ui {

struct FrameJob {
    std::shared_ptr<const Ready> ready;
    Settings settings;                       // as wished; what `ready` was not prepared for is ignored
    std::optional<Settings> other_settings;  // traced too, if `ready` has that side
    View view;
    uint64_t revision = 0;          // a new number: the films start anew
    uint64_t display_revision = 0;  // a new number: the films are shown anew
    bool continuous = false;        // trace on and on, for measuring
    float resolution_scale = 1;     // of the settings' size, each way
    float moving_fps = 0;           // > 0: so many frames a second matter more than pixels now
};

// One side of a picture.
struct PictureSide {
    ByteImage image;
    FalseColorScale scale;  // of an AOV; without a unit for colours
    Settings settings;      // as traced
    FrameStats stats;
    double frame_ms = 0;                         // what it took of the thread: tracing, and reading back if that held it up
    std::shared_ptr<const FloatImage> distance;  // of the camera rays of sample 0, +inf: nothing; nullptr if not asked for,
                                                 // empty where it is not known
    std::shared_ptr<const FloatImage> values;    // what a picture with a scale shows; else nullptr
};

// How two images differ.
struct PictureDifference {
    ByteImage image;               // |a - b| in each channel, eight times as bright
    double mean = 0, largest = 0;  // of 255
    double share = 0;              // of pixels that differ by more than 1 of 255
};

struct Picture {
    FrameJob job;
    PictureSide main;
    std::optional<PictureSide> other;
    std::optional<PictureDifference> difference;
    bool reduced = false;  // fewer pixels than asked for, because something moves
};

class FrameThread {
 public:
    explicit FrameThread(std::function<void()> wake);
    ~FrameThread();

    void post(FrameJob job);
    std::shared_ptr<const Picture> latest() const;
    // Nothing left to trace of what was posted.
    bool idle() const;
    // Empty, or why frames stopped; once.
    std::string take_failure();
    // Milliseconds of a side's last frames, oldest first.
    std::vector<float> times(unsigned side = 0) const;
    // From now on pictures bring their distances, or do not.
    void want_distance(bool wanted);
    // Writes the main picture once all its samples are in. Returns a number that take_saved() names the outcome by.
    uint64_t save(const std::string& path);
    // Forgets that picture, unless it is being written already.
    void cancel_save(uint64_t number);
    // Ends the frame in hand and lets go of all that is on a device, until resume(): so that devices can be closed.
    void release();
    void resume();
    struct Saved {
        uint64_t number = 0;
        std::string path, failure;  // empty failure: it is there
    };
    std::vector<Saved> take_saved();

 private:
    class StopProgress;
    // What traces one side; of the thread alone.
    struct Tracer {
        Devices devices;
        std::unique_ptr<MultiFrameRenderer> frames;
        uint64_t kernel_revision = 0;  // that the film's kernels are of
    };
    struct Times {
        std::vector<float> ms;
        std::shared_ptr<const Ready> of;
        bool cold = false;  // only its first frame is in
    };
    // A picture whose images may still be on their way.
    struct Traced {
        std::shared_ptr<Picture> picture;
        AsyncReadback images[2];  // of its sides
        bool fresh = false;       // not only shown anew
        // The finished picture that is traced again for its times: its images are shown until all samples are in again.
        std::shared_ptr<const Picture> finished;
    };
    void run();
    void trace(const FrameJob& job, unsigned sample, bool retrace);
    struct Order {  // what of a side is to be done
        unsigned sample = 0;
        bool retrace = false, distance = false;
    };
    PictureSide trace_side(Tracer& tracer, const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                           const View& view, const Order& order, const PictureSide* last, Progress& progress,
                           AsyncReadback& image);
    bool finish(bool held_up);
    bool wants_work(unsigned& sample, bool& retrace) const;
    void fit_tracer(Tracer& tracer, const Devices& devices, uint64_t kernel_revision);
    bool has_saving() const;
    void save_waiting();
    float moving_scale(const FrameJob& job) const;
    static void keep_image(PictureSide& side, const PictureSide& finished);
    static void note_time(Times& times, const std::shared_ptr<const Ready>& of, double ms);

    const std::function<void()> wake_;
    Tracer tracers_[2];
    double ms_per_pixel_ = 0;             // of the last picture; 0: not known
    std::shared_ptr<const Ready> paced_;  // what it is of

    mutable std::mutex mutex_;
    std::condition_variable changed_, stopped_;
    bool stop_ = false, tracing_ = false, failed_ = false, distance_ = false, released_ = false;
    FrameJob job_;
    uint64_t traced_revision_ = 0, shown_revision_ = 0;
    bool traced_reduced_ = false;  // the films hold fewer pixels than asked for
    unsigned samples_ = 0;         // in the films
    std::shared_ptr<StopProgress> running_;
    std::optional<Traced> traced_;  // newer than latest_, which it becomes when its images are here
    std::shared_ptr<const Picture> latest_;
    std::string failure_;
    Times times_[2];
    std::vector<Saved> to_save_, saved_;  // without an outcome yet; with one that nobody took
    uint64_t last_save_ = 0;              // number of it
    std::thread thread_;                  // last: it sees the rest complete
};

// The settings to trace with: those of `wished` that apply at once, the others as prepared.
Settings frame_settings(const Settings& prepared, const Settings& desired_now);

}  // namespace clarity::ui
