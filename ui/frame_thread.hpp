// frame_thread.hpp -- the thread that traces: takes the newest wish, leaves the newest picture.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "render/renderer.hpp"
#include "ui/prepare_worker.hpp"

namespace clarity {

struct FrameJob {
    std::shared_ptr<const Ready> ready;
    Settings settings;  // as wished; what `ready` was not prepared for is ignored
    View view;
    uint64_t revision = 0;          // a new number: the film starts anew
    uint64_t display_revision = 0;  // a new number: the film is shown anew
    bool continuous = false;        // trace on and on, for measuring
};

struct Picture {
    ByteImage image;
    FrameJob job;
    FrameStats stats;
    double frame_ms = 0;  // tracing and reading back
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
    // Milliseconds of the last frames, oldest first.
    std::vector<float> times() const;

 private:
    class StopProgress;
    void run();
    void trace(const FrameJob& job, unsigned sample, bool retrace);
    bool wants_work(unsigned& sample, bool& retrace) const;

    const std::function<void()> wake_;
    // Of the thread alone.
    std::shared_ptr<Device> device_;
    std::unique_ptr<Frames> frames_;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false, tracing_ = false, failed_ = false;
    FrameJob job_;
    uint64_t traced_revision_ = 0, shown_revision_ = 0;
    unsigned samples_ = 0;  // in the film
    std::shared_ptr<StopProgress> running_;
    std::shared_ptr<const Picture> latest_;
    std::string failure_;
    std::vector<float> times_;
    std::shared_ptr<const Ready> timed_;  // what times_ are of
    bool cold_ = false;                   // times_ holds only its first frame
    std::thread thread_;                  // last: it sees the rest complete
};

// The settings to trace with: those of `wished` that apply at once, the others as prepared.
Settings frame_settings(const Settings& prepared, const Settings& wished);

}  // namespace clarity
