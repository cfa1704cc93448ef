// inspect_thread.hpp -- the thread that traces the rays of one pixel, or its samples once more, independent of the thread that
// traces pictures. Of each kind only the newest request is answered.
#pragma once
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "tools/why/noise.hpp"
#include "tracers/inspect/inspect.hpp"
#include "ui/threads/picture.hpp"

namespace clarity::ui {

// The answer to a request: the rays of one pixel.
struct Inspection {
    FrameJob job;           // of the inspected picture
    unsigned x = 0, y = 0;  // pixel of that picture
    RayTree result;
    std::string failure;   // why there are no rays; empty: there are
    uint64_t request = 0;  // the number which ask() returned
};

// Why a pixel of the tracer `path` is noisy.
struct NoiseInspection {
    FrameJob job;
    unsigned x = 0, y = 0;
    NoiseNames names;
    Replay replay;
    NoiseReport report;
    SamplerPoints points;  // the random numbers of the samples, of a few events
    std::string failure;   // why there is no report; empty: there is
};

// The thread. All public members may be called from any thread; only release() waits.
class InspectThread {
 public:
    explicit InspectThread(std::function<void()> wake);
    ~InspectThread();
    // Requests the rays of pixel (x, y) of the job's picture. Replaces a waiting request. Returns the request's number.
    uint64_t ask(FrameJob job, unsigned x, unsigned y);
    std::shared_ptr<const Inspection> latest() const;  // nullptr until the first answer
    // The same for the samples of a pixel. names: of the job's lights.
    void ask_why(FrameJob job, unsigned x, unsigned y, std::vector<std::string> names);
    std::shared_ptr<const NoiseInspection> latest_noise() const;
    bool busy() const;
    // As in FrameThread.
    void release();
    void resume();

 private:
    struct Request {
        FrameJob job;
        unsigned x = 0, y = 0;
        uint64_t number = 0;
    };
    void run();
    std::shared_ptr<const Inspection> answer(const Request& request);
    std::shared_ptr<const NoiseInspection> answer_why(NoiseInspection request);
    // Of the job's main side; nullptr: its devices were closed, and its picture is about to be replaced.
    std::shared_ptr<const Prepared> open(const FrameJob& job);

    const std::function<void()> wake_;
    std::shared_ptr<Device> device_;  // used by the thread only, like inspector_
    std::unique_ptr<Inspector> inspector_;
    std::unique_ptr<PathReplayer> replayer_;
    mutable std::mutex mutex_;
    std::condition_variable changed_, stopped_;
    bool stop_ = false, running_ = false, released_ = false;
    uint64_t last_number_ = 0;
    std::unique_ptr<Request> waiting_;
    std::unique_ptr<NoiseInspection> waiting_noise_;  // without an answer
    std::shared_ptr<const Inspection> latest_;
    std::shared_ptr<const NoiseInspection> latest_noise_;
    std::thread thread_;  // last member: the thread starts when all others exist
};

}  // namespace clarity::ui
