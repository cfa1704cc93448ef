#include "ui/threads/inspect_thread.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "ui/threads/thread_priority.hpp"

namespace clarity::ui {
namespace {

// As many samples as the picture has, but enough to see a cause, and few enough to be there soon.
constexpr int kLeastReplayed = 256, kMostReplayed = 4096;
constexpr int kShownEvents = 4;  // of which the random numbers are shown

}  // namespace

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

void InspectThread::ask_why(FrameJob job, unsigned x, unsigned y, std::vector<std::string> names) {
    auto request = std::make_unique<NoiseInspection>();
    request->job = std::move(job);
    request->x = x;
    request->y = y;
    request->names.lights = std::move(names);
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_noise_ = std::move(request);
    changed_.notify_all();
}

std::shared_ptr<const NoiseInspection> InspectThread::latest_noise() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return latest_noise_;
}

std::shared_ptr<const Inspection> InspectThread::latest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return latest_;
}

bool InspectThread::busy() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return running_ || waiting_ || waiting_noise_;
}

void InspectThread::release() {
    std::unique_lock<std::mutex> lock(mutex_);
    released_ = true;
    stopped_.wait(lock, [this] { return !running_; });
    inspector_.reset();
    replayer_.reset();
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
        std::unique_ptr<Request> request;
        std::unique_ptr<NoiseInspection> why;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            running_ = false;
            stopped_.notify_all();
            changed_.wait(lock, [this] { return stop_ || ((waiting_ || waiting_noise_) && !released_); });
            if (stop_) return;
            request = std::move(waiting_);
            if (!request) why = std::move(waiting_noise_);
            running_ = true;
        }
        if (request) {
            auto rays = answer(*request);
            const std::lock_guard<std::mutex> lock(mutex_);
            latest_ = std::move(rays);
        } else {
            auto noise = answer_why(std::move(*why));
            const std::lock_guard<std::mutex> lock(mutex_);
            latest_noise_ = std::move(noise);
        }
        wake_();
    }
}

std::shared_ptr<const Inspection> InspectThread::answer(const Request& request) {
    auto answer = std::make_shared<Inspection>();
    answer->job = request.job;
    answer->x = request.x;
    answer->y = request.y;
    answer->request = request.number;
    try {
        if (const auto prepared = open(request.job))
            answer->result = inspector_->trace(*prepared, request.job.settings, request.job.view, request.x, request.y);
    } catch (const std::exception& error) {
        answer->failure = std::string("the pixel's rays cannot be followed: ") + error.what();
    }
    return answer;
}

std::shared_ptr<const NoiseInspection> InspectThread::answer_why(NoiseInspection request) {
    auto answer = std::make_shared<NoiseInspection>(std::move(request));
    const FrameJob& job = answer->job;
    try {
        if (job.open_s > 0)
            throw Error(Exit::usage, "each sample of a picture with motion blur shows another pose; `clarity why` traces them");
        const auto prepared = open(job);
        if (!prepared) throw Error(Exit::failed, "the device was closed; ask again");
        if (prepared->settings.tracer != "path") throw Error(Exit::usage, "only pictures of the tracer `path` have noise");
        if (!replayer_) replayer_ = std::make_unique<PathReplayer>(device_);
        const auto samples = static_cast<unsigned>(std::clamp(job.settings.spp, kLeastReplayed, kMostReplayed));
        Progress never_cancelled;
        replayer_->trace(*prepared, job.settings, job.view, answer->x, answer->y, samples, never_cancelled, answer->replay);
        answer->points = replayer_->points(*prepared, job.settings, job.view, answer->x, answer->y, samples,
                                           unsigned(std::min(job.settings.depth, kShownEvents)), never_cancelled);
        answer->names.strategy = job.settings.strategy;
        answer->report = noise_report(answer->replay, answer->names);
    } catch (const std::exception& error) {
        answer->failure = std::string("the pixel's samples cannot be traced once more: ") + error.what();
    }
    return answer;
}

std::shared_ptr<const Prepared> InspectThread::open(const FrameJob& job) {
    const auto side = job.ready->main.loan->get();
    if (!side) return nullptr;
    const MultiPrepared::Part& part = side->prepared->parts.front();
    std::shared_ptr<const Prepared> prepared(side, part.prepared.get());  // keeps the loan while it is used
    if (device_ != part.device) {
        inspector_.reset();
        replayer_.reset();
        device_ = part.device;
        inspector_ = std::make_unique<Inspector>(device_);
    }
    return prepared;
}

}  // namespace clarity::ui
