// inspect_thread.hpp -- the thread that traces the rays of one pixel, independent of the thread that traces pictures. Only the
// newest request is answered.
#pragma once
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "render/tracers/inspect/inspect.hpp"
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

// The thread. All public members may be called from any thread; only release() waits.
class InspectThread {
 public:
    explicit InspectThread(std::function<void()> wake);
    ~InspectThread();
    // Requests the rays of pixel (x, y) of the job's picture. Replaces a waiting request. Returns the request's number.
    uint64_t ask(FrameJob job, unsigned x, unsigned y);
    std::shared_ptr<const Inspection> latest() const;  // nullptr until the first answer
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
    void follow(const Request& request, Inspection& answer);

    const std::function<void()> wake_;
    std::shared_ptr<Device> device_;  // used by the thread only, like inspector_
    std::unique_ptr<Inspector> inspector_;
    mutable std::mutex mutex_;
    std::condition_variable changed_, stopped_;
    bool stop_ = false, running_ = false, released_ = false;
    uint64_t last_number_ = 0;
    std::unique_ptr<Request> waiting_;
    std::shared_ptr<const Inspection> latest_;
    std::thread thread_;  // last member: the thread starts when all others exist
};

}  // namespace clarity::ui
