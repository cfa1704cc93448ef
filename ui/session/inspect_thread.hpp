// inspect_thread.hpp -- the thread that follows one pixel's rays, beside the one that traces pictures. The newest wish wins.
#pragma once
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "render/frame/inspect.hpp"
#include "ui/session/frame_thread.hpp"

namespace clarity::ui {

struct Inspection {
    FrameJob job;           // of the picture that was looked at
    unsigned x = 0, y = 0;  // pixel of it
    RayTree result;
    std::string failure;   // empty, or why there are no rays
    uint64_t request = 0;  // number that ask() gave
};

class InspectThread {
 public:
    explicit InspectThread(std::function<void()> wake);
    ~InspectThread();
    uint64_t ask(FrameJob job, unsigned x, unsigned y);
    std::shared_ptr<const Inspection> latest() const;  // nullptr at first
    bool busy() const;
    // As FrameThread has them.
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
    std::shared_ptr<Device> device_;  // of the thread alone, as is
    std::unique_ptr<Inspector> inspector_;
    mutable std::mutex mutex_;
    std::condition_variable changed_, stopped_;
    bool stop_ = false, running_ = false, released_ = false;
    uint64_t last_number_ = 0;
    std::unique_ptr<Request> waiting_;
    std::shared_ptr<const Inspection> latest_;
    std::thread thread_;  // last: it sees the rest complete
};

}  // namespace clarity::ui
