#include "ui/frame_thread.hpp"

#include <algorithm>
#include <chrono>

#include "base/error.hpp"
#include "ui/thread_priority.hpp"

namespace clarity {

using Clock = std::chrono::steady_clock;

class FrameThread::StopProgress : public Progress {};

Settings frame_settings(const Settings& prepared, const Settings& wished) {
    Settings settings = prepared;
    for (const Setting& row : settings_table())
        if (row.effect == Effect::frame) row.set(settings, row.get(wished));
    return settings;
}

FrameThread::FrameThread(std::function<void()> wake) : wake_(std::move(wake)), thread_([this] { run(); }) {}

FrameThread::~FrameThread() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
        if (running_) running_->cancel();
    }
    changed_.notify_all();
    thread_.join();
}

void FrameThread::post(FrameJob job) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        // The first sample of a view is always finished, so that a slow picture still follows a moving camera; later samples
        // are refinement, and give way at once.
        if (running_ && job.revision != job_.revision && samples_ > 0) running_->cancel();
        job_ = std::move(job);
        failed_ = false;
    }
    changed_.notify_all();
}

std::shared_ptr<const Picture> FrameThread::latest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return latest_;
}

bool FrameThread::idle() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    unsigned sample = 0;
    bool retrace = false;
    return !tracing_ && !wants_work(sample, retrace);
}

std::string FrameThread::take_failure() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(failure_, {});
}

std::vector<float> FrameThread::times() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return times_;
}

// With the lock held: whether there is something to do, which sample, and whether it needs tracing at all.
bool FrameThread::wants_work(unsigned& sample, bool& retrace) const {
    if (!job_.ready || failed_) return false;
    const bool fresh = job_.revision != traced_revision_;
    sample = fresh ? 0 : samples_;
    retrace = fresh || samples_ < static_cast<unsigned>(job_.settings.spp);
    if (!retrace && job_.continuous) {
        sample = 0;
        retrace = true;
    }
    return retrace || job_.display_revision != shown_revision_;
}

void FrameThread::run() {
    yield_to_window();
    for (;;) {
        FrameJob job;
        unsigned sample = 0;
        bool retrace = false;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            changed_.wait(lock, [&] { return stop_ || wants_work(sample, retrace); });
            if (stop_) return;
            job = job_;
            tracing_ = true;
            running_ = std::make_shared<StopProgress>();
            if (sample == 0 && retrace) samples_ = 0;
        }
        std::string failure;
        try {
            trace(job, sample, retrace);
        } catch (const Cancelled&) {
        } catch (const std::exception& error) {
            failure = std::string("tracing stopped: ") + error.what();
        }
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            tracing_ = false;
            running_.reset();
            if (!failure.empty()) {
                failure_ = failure;
                failed_ = job_.revision == job.revision;
            }
        }
        wake_();
    }
}

void FrameThread::trace(const FrameJob& job, unsigned sample, bool retrace) {
    if (device_ != job.ready->device) {
        frames_.reset();
        device_ = job.ready->device;
        frames_ = std::make_unique<Frames>(device_);
    }
    std::shared_ptr<StopProgress> progress;
    std::shared_ptr<const Picture> last;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        progress = running_;
        last = latest_;
    }
    const Settings settings = frame_settings(job.ready->prepared->settings, job.settings);
    auto picture = std::make_shared<Picture>();
    picture->job = job;
    picture->job.settings = settings;
    const auto begin = Clock::now();
    if (retrace)
        picture->stats = frames_->trace(*job.ready->prepared, settings, job.view, sample, true, *progress);
    else if (last)
        picture->stats = last->stats;
    picture->image = frames_->read_display(settings);
    picture->frame_ms = std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
    if (!retrace && last) picture->frame_ms = last->frame_ms;

    const std::lock_guard<std::mutex> lock(mutex_);
    latest_ = std::move(picture);
    traced_revision_ = job.revision;
    shown_revision_ = job.display_revision;
    if (!retrace) return;
    samples_ = sample + 1;
    constexpr size_t kTimes = 120;
    // Times of another program say nothing of this one, nor does its first frame: drivers compile the last bit then.
    if (timed_ != job.ready) {
        times_.clear();
        timed_ = job.ready;
        cold_ = true;
    } else if (cold_) {
        times_.clear();
        cold_ = false;
    }
    times_.push_back(static_cast<float>(latest_->frame_ms));
    if (times_.size() > kTimes) times_.erase(times_.begin());
}

}  // namespace clarity
