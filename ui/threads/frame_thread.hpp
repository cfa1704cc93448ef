// frame_thread.hpp -- the thread that traces pictures: it takes the newest job and publishes the newest picture.
//
// Some devices copy while they trace. There, the thread starts the next picture before it copies the last one, if there is a
// next one to trace. Each picture arrives as soon as it would otherwise, and there are more pictures in the same time.
//
// The sides of a comparison are traced and copied strictly one after the other. All devices share the processor, which serves
// GPUs: what overlaps would count as the time of the wrong side.
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

#include "device/async_readback.hpp"
#include "stand/multi_frame_renderer.hpp"
#include "ui/threads/picture.hpp"

namespace clarity::ui {

// The thread that traces pictures. All public members may be called from any thread; only release() waits.
class FrameThread {
 public:
    // wake: called from the tracing thread when latest(), take_failure() or take_saved() may have news.
    explicit FrameThread(std::function<void()> wake);
    ~FrameThread();

    // Replaces the job. A running sample is cancelled if the revision changed and the view has a sample already.
    void post(FrameJob job);
    // Returns the newest picture; nullptr until the first.
    std::shared_ptr<const Picture> latest() const;
    // Whether everything that was posted is traced.
    bool idle() const;
    // Whether the posted job is being traced, or was, or cannot be.
    bool begun() const;
    // Seconds since the work in hand gave a sign of life, which a trace does between two launches. 0 if there is none.
    double silent_s() const;
    // Returns why tracing stopped, and forgets it. Empty: it did not.
    std::string take_failure();
    // The last times of a side, oldest first.
    FrameTimes times(unsigned side = 0) const;
    // Whether pictures carry the distances of their camera rays from now on.
    void want_distance(bool wanted);
    // Writes the main picture once all of its samples are traced. The file names `command`, which makes the picture of the last
    // job, unless another job is posted before. Returns the number of the save, which take_saved() repeats.
    uint64_t save(const std::string& path, const std::string& command);
    // Drops the save with this number, unless it is being written already.
    void cancel_save(uint64_t number);
    // Stops the frame in progress and releases everything this thread holds on a device, so that devices can be closed. Returns
    // when that is done. Nothing is traced until resume().
    void release();
    void resume();
    struct Saved {
        uint64_t number = 0;
        std::string path, failure;  // failure is empty if the picture was written
    };
    // Returns the outcomes of saves since the last call.
    std::vector<Saved> take_saved();

 private:
    class StopProgress;
    // Traces one side. Only this thread uses it.
    struct Tracer {
        Devices devices;
        std::unique_ptr<MultiFrameRenderer> frames;
        uint64_t kernel_revision = 0;  // revision of the film's kernels
        std::unique_ptr<MotionBlur> blur;
        std::shared_ptr<const Ready> blur_of;  // what it was made for
        Convergence convergence;               // of its film
        unsigned samples = 0;                  // in its film
    };
    struct Save {
        Saved outcome;
        std::string command;  // of the job with these revisions
        uint64_t revision = 0, display_revision = 0;
    };
    // A traced picture, the images of which may still be in flight to the host.
    struct Traced {
        std::shared_ptr<Picture> picture;
        AsyncReadback image;  // of the main side; in a comparison there is none
        bool fresh = false;   // was traced; false: it was only displayed again
        // The finished picture, if this one is traced again for its times. Its images are shown until all samples are traced
        // again.
        std::shared_ptr<const Picture> finished;
    };
    void run();
    void trace(const FrameJob& job, unsigned sample, bool retrace);
    struct Order {  // what is to be done for a side
        unsigned sample = 0;
        bool retrace = false, distance = false;
        bool last = false;   // all samples are traced then
        double until_s = 0;  // further samples follow until it has so many seconds
        const FloatImage* reference = nullptr;
        bool overlaps = false;  // the image may be copied while the next picture is traced
    };
    PictureSide trace_side(Tracer& tracer, const std::shared_ptr<const MultiPrepared>& prepared, const Settings& settings,
                           const View& view, const Order& order, const PictureSide* last, Progress& progress,
                           AsyncReadback& image);
    static void note_error(Tracer& tracer, const Settings& settings, const FloatImage* reference);
    static MotionBlur::Sample sample_of(Tracer& tracer, const FrameJob& job, const ReadySide& side, const OnDevices& on_devices,
                                        unsigned sample, Progress& progress);
    bool finish(bool held_up);
    bool wants_work(unsigned& sample, bool& retrace) const;
    void fit_tracer(Tracer& tracer, const Devices& devices, uint64_t kernel_revision);
    bool has_saving() const;
    void save_waiting();
    float moving_scale(const FrameJob& job) const;

    const std::function<void()> wake_;
    Tracer tracers_[2];
    Surroundings surroundings_;
    double ms_per_pixel_ = 0;             // of the last picture; 0: not known
    uint64_t told_revision_ = 0;          // of the job of which the log has named samples that are not finite
    std::shared_ptr<const Ready> paced_;  // what ms_per_pixel_ was measured with

    mutable std::mutex mutex_;
    std::condition_variable changed_, stopped_;
    bool stop_ = false, tracing_ = false, failed_ = false, distance_ = false, released_ = false;
    FrameJob job_;
    uint64_t traced_revision_ = 0, shown_revision_ = 0;
    uint64_t begun_revision_ = 0;  // of the job that was begun last
    bool traced_reduced_ = false;  // the films hold fewer pixels than asked for
    unsigned samples_ = 0;         // number of samples in the films
    std::shared_ptr<StopProgress> running_;
    std::optional<Traced> traced_;  // newer than latest_, and replaces it when its images have arrived
    std::shared_ptr<const Picture> latest_;
    std::string failure_;
    FrameTimes times_[2];
    std::vector<Save> to_save_;  // saves that wait
    std::vector<Saved> saved_;   // finished saves which take_saved() has not returned yet
    uint64_t last_save_ = 0;     // number of the last save
    std::thread thread_;         // last member: the thread starts when all others exist
};

}  // namespace clarity::ui
