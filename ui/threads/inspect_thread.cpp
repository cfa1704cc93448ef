#include "ui/threads/inspect_thread.hpp"

#include "ui/threads/thread_priority.hpp"

namespace clarity::ui {

InspectThread::InspectThread(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { run(); }) {}

InspectThread::~InspectThread() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

uint64_t InspectThread::ask(FrameJob job, unsigned x, unsigned y) {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_ = std::make_unique<Request>(Request{std::move(job), x, y, ++last_number_});
    changed_.notify_all();
    return last_number_;
}

std::shared_ptr<const Inspection> InspectThread::latest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return latest_;
}

bool InspectThread::busy() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return running_ || waiting_;
}

void InspectThread::release() {
    std::unique_lock<std::mutex> lock(mutex_);
    released_ = true;
    stopped_.wait(lock, [this] { return !running_; });
    inspector_.reset();
    device_.reset();
}

void InspectThread::resume() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        released_ = false;
    }
    changed_.notify_all();
}

void InspectThread::run() {
    yield_to_window();
    for (;;) {
        Request request;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            running_ = false;
            stopped_.notify_all();
            changed_.wait(lock, [this] { return stop_ || (waiting_ && !released_); });
            if (stop_) return;
            request = std::move(*waiting_);
            waiting_.reset();
            running_ = true;
        }
        auto answer = std::make_shared<Inspection>();
        answer->job = request.job;
        answer->x = request.x;
        answer->y = request.y;
        answer->request = request.number;
        try {
            follow(request, *answer);
        } catch (const std::exception& error) {
            answer->failure = std::string("the pixel's rays cannot be followed: ") + error.what();
        }
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            latest_ = std::move(answer);
        }
        wake_();
    }
}

void InspectThread::follow(const Request& request, Inspection& answer) {
    const auto side = request.job.ready->main.loan->get();
    if (!side) return;  // its devices were closed, and its picture is about to be replaced
    const MultiPrepared::Part& part = side->prepared->parts.front();
    if (device_ != part.device) {
        inspector_.reset();
        device_ = part.device;
        inspector_ = std::make_unique<Inspector>(device_);
    }
    answer.result = inspector_->trace(*part.prepared, request.job.settings, request.job.view, request.x, request.y);
}

}  // namespace clarity::ui
