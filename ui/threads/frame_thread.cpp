#include "ui/threads/frame_thread.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "tools/compare/picture_errors.hpp"
#include "ui/threads/picture.hpp"
#include "ui/threads/thread_priority.hpp"
#include "view/settings/aov.hpp"

namespace clarity::ui {

using Clock = std::chrono::steady_clock;

// Between two launches the tracer asks whether it is to stop. The time of the last question is its last sign of life.
class FrameThread::StopProgress : public Progress {
 public:
    bool cancelled() const override {
        last_sign_ = Clock::now();
        return Progress::cancelled();
    }
    double silent_s() const { return seconds_since(last_sign_); }

 private:
    mutable std::atomic<Clock::time_point> last_sign_{Clock::now()};
};

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
        // The first sample of a view is always finished, so that a slow picture still follows a moving camera. Later samples
        // only refine the picture, so they are cancelled at once.
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
    return !tracing_ && !traced_ && !wants_work(sample, retrace);
}

bool FrameThread::begun() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !job_.ready || !job_.known || failed_ || released_ || job_.ready->withdrawn() || job_.ready->lost() ||
           job_.revision == begun_revision_;
}

double FrameThread::silent_s() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return running_ ? running_->silent_s() : 0;
}

std::string FrameThread::take_failure() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(failure_, {});
}

FrameTimes FrameThread::times(unsigned side) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return times_[side];
}

void FrameThread::want_distance(bool wanted) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (wanted == distance_) return;
    distance_ = wanted;
    changed_.notify_all();
}

uint64_t FrameThread::save(const std::string& path, const std::string& command) {
    const std::lock_guard<std::mutex> lock(mutex_);
    to_save_.push_back({{++last_save_, path, {}}, command, job_.revision, job_.display_revision});
    changed_.notify_all();
    return last_save_;
}

void FrameThread::cancel_save(uint64_t number) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto it = [&](const Save& waiting) { return waiting.outcome.number == number; };
    to_save_.erase(std::remove_if(to_save_.begin(), to_save_.end(), it), to_save_.end());
}

void FrameThread::release() {
    std::unique_lock<std::mutex> lock(mutex_);
    released_ = true;
    if (running_) running_->cancel();
    stopped_.wait(lock, [this] { return !tracing_ && !traced_; });
    for (Tracer& tracer : tracers_) tracer = {};
}

void FrameThread::resume() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        released_ = false;
    }
    changed_.notify_all();
}

std::vector<FrameThread::Saved> FrameThread::take_saved() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(saved_, {});
}

// Whether there is something to do, which sample is next, and whether it must be traced. The caller holds the lock.
bool FrameThread::wants_work(unsigned& sample, bool& retrace) const {
    retrace = false;
    if (!job_.ready || !job_.known || failed_ || released_ || job_.ready->withdrawn() || job_.ready->lost()) return false;
    const bool sharpen = traced_reduced_ && job_.moving_fps <= 0;
    const bool fresh = job_.revision != traced_revision_ || sharpen;
    sample = fresh ? 0 : samples_;
    // A reduced picture gets one sample only: while the view moves, the next step would discard the others.
    retrace = fresh || (!traced_reduced_ && samples_ < static_cast<unsigned>(job_.settings.spp));
    // A comparison gets a few more frames, because the first frames of a program are slower.
    constexpr size_t kFairFrames = 5;
    const bool comparing = job_.other_settings && job_.ready->other && !traced_reduced_;
    const bool unfair = comparing && std::min(times_[0].size(), times_[1].size()) < kFairFrames;
    if (!retrace && (job_.continuous || unfair)) {
        sample = 0;
        retrace = true;
    }
    const bool distance = distance_ && latest_ && !latest_->main.distance;
    return retrace || distance || job_.display_revision != shown_revision_ || has_saving();
}

// Whether a save is waiting and the films hold the finished picture for it. The caller holds the lock.
bool FrameThread::has_saving() const {
    return !to_save_.empty() && latest_ && !failed_ && job_.revision == traced_revision_ && !traced_reduced_ &&
           samples_ >= static_cast<unsigned>(job_.settings.spp) && job_.display_revision == shown_revision_;
}

void FrameThread::run() {
    yield_to_window();
    for (;;) {
        FrameJob job;
        unsigned sample = 0;
        bool retrace = false, save = false, settle = false;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            changed_.wait(lock, [&] { return wants_work(sample, retrace) || traced_ || stop_; });
            if (stop_) return;
            job = job_;
            save = has_saving();
            settle = traced_ && (save || !retrace);  // there is nothing to trace while the images are copied
            tracing_ = true;
            if (!settle && !save) begun_revision_ = job.revision;
            running_ = std::make_shared<StopProgress>();
            if (sample == 0 && retrace && !save) samples_ = 0;
        }
        std::string failure;
        bool lost = false;
        try {
            if (settle)
                finish(true);
            else if (save)
                save_waiting();
            else
                trace(job, sample, retrace);
        } catch (const Cancelled&) {
        } catch (const SamplesLost&) {
            lost = true;
        } catch (const std::exception& error) {
            failure = std::string("tracing stopped: ") + error.what();
        }
        bool news = false;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            tracing_ = false;
            running_.reset();
            if (lost) traced_revision_ = 0;  // the picture begins again
            if (!failure.empty()) {
                failure_ = failure;
                failed_ = job_.revision == job.revision;
            }
            news = !traced_;
        }
        stopped_.notify_all();
        if (news) wake_();
    }
}

void FrameThread::save_waiting() {
    std::vector<Save> waiting;
    std::shared_ptr<const Picture> picture;
    uint64_t revision = 0, display_revision = 0;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        waiting.swap(to_save_);
        picture = latest_;
        revision = job_.revision;
        display_revision = job_.display_revision;
    }
    for (Save& save : waiting) {
        Saved& outcome = save.outcome;
        PictureNotes notes = picture_notes(denoises(picture->main.settings));
        if (save.revision == revision && save.display_revision == display_revision)
            notes.texts.emplace_back("Command", save.command);
        try {
            if (writes_display(outcome.path))
                write_image(outcome.path, {}, cropped(picture->main.image, picture->main.settings), notes);
            else
                write_image(outcome.path, tracers_[0].frames->read_picture(picture->main.settings), {}, notes);
        } catch (const std::exception& error) {
            outcome.failure = error.what();
        }
        const std::lock_guard<std::mutex> lock(mutex_);
        saved_.push_back(outcome);
    }
}

// The factor for width and height at which the expected frame time meets job.moving_fps.
float FrameThread::moving_scale(const FrameJob& job) const {
    if (job.moving_fps <= 0 || ms_per_pixel_ <= 0 || !paced_ || !traces_alike(*paced_, *job.ready)) return 1;
    const double pixels = double(job.settings.width) * job.settings.height * job.resolution_scale * job.resolution_scale;
    const double expected = ms_per_pixel_ * pixels, budget = 1000.0 / job.moving_fps;
    if (expected <= budget) return 1;
    // The factor has 16 steps, so that the picture's resolution does not change in every frame.
    const double steps = std::floor(std::sqrt(budget / expected) * 16);
    return static_cast<float>(std::clamp(steps, 2.0, 16.0) / 16);
}

// How far the film is from what it should be: estimated, and known if there is a reference of its size.
void FrameThread::note_error(Tracer& tracer, const Settings& settings, const FloatImage* reference) {
    const bool comparable = reference && int(reference->width) == settings.width && int(reference->height) == settings.height &&
                            find_aov(settings.aov).is_color();
    tracer.convergence.put(tracer.frames->noise(),
                           comparable ? rmse_of(tracer.frames->read_picture(settings), *reference) : std::nan(""));
}

PictureSide FrameThread::trace_side(Tracer& tracer, const std::shared_ptr<const MultiPrepared>& prepared,
                                    const Settings& settings, const View& view, const Order& order, const PictureSide* last,
                                    Progress& progress, AsyncReadback& image) {
    PictureSide side;
    side.settings = settings;
    auto begin = Clock::now();
    if (order.retrace) {
        const auto show_last = [this] {
            if (finish(false)) wake_();
        };
        tracer.samples = order.sample;
        do {
            begin = Clock::now();
            side.stats = tracer.frames->trace(prepared, settings, view, tracer.samples, true, progress, 1, show_last);
            if (tracer.convergence.add(tracer.samples++, side.stats.wall_ms) && tracer.frames->planes() > 1)
                note_error(tracer, settings, order.reference);
        } while (tracer.convergence.seconds() < order.until_s);
    } else if (last) {
        side.stats = traced_part(last->stats);
    }
    if (order.last && tracer.frames->planes() > 1) note_error(tracer, settings, order.reference);
    if (denoises(settings) && !tracer.frames->has_guides()) side.settings.denoise = "off";  // its kernels are on their way
    if (tracer.frames->overlaps_copies()) {
        image = tracer.frames->begin_display(settings);
        if (!order.overlaps) side.image = std::exchange(image, {}).wait(&side.stats.kernels);
    } else {
        side.image = tracer.frames->read_display(settings, &side.stats, &side.scale);
    }
    side.frame_ms = ms_since(begin);
    side.convergence = tracer.convergence;
    if (side.scale.map != FalseColorScale::Map::none)
        side.values = std::make_shared<const FloatImage>(
            in_whole(tracer.frames->read_values(), settings, std::numeric_limits<float>::quiet_NaN()));
    if (!order.retrace && last) side.frame_ms = last->frame_ms;
    if (order.distance) {
        if (last && last->distance && order.sample > 0)
            side.distance = last->distance;
        else
            side.distance = std::make_shared<const FloatImage>(
                in_whole(tracer.frames->read_distance(), settings, std::numeric_limits<float>::infinity()));
    }
    return side;
}

// Waits for the image of the picture that was traced last, then publishes it as latest_. Returns false if there is none.
// held_up: this thread does nothing else while it waits, so the time counts as frame time.
bool FrameThread::finish(bool held_up) {
    Traced traced;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (!traced_) return false;
        traced = std::move(*traced_);
        traced_.reset();
    }
    Picture& picture = *traced.picture;
    if (traced.image) {
        const auto begin = Clock::now();
        picture.main.image = traced.image.wait(&picture.main.stats.kernels);
        if (held_up && traced.fresh) picture.main.frame_ms += ms_since(begin);
    }
    if (picture.other) {
        share_scale(picture.main, *picture.other);
        picture.difference = compare_pictures(picture.main.image, picture.other->image);
    }
    surroundings_.put_around(picture);
    if (traced.finished) {
        keep_image(picture.main, traced.finished->main);
        if (picture.other && traced.finished->other) keep_image(*picture.other, *traced.finished->other);
        picture.difference = traced.finished->difference;
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    latest_ = traced.picture;
    if (!traced.fresh) return true;
    times_[0].add(picture.job.ready, picture.main);
    if (picture.other)
        times_[1].add(picture.job.ready, *picture.other);
    else
        times_[1] = {};
    return true;
}

// Creates the tracer's renderer if the devices or the kernels changed, since the film has kernels of its own. If edited kernels
// do not compile, the last good renderer stays in use.
void FrameThread::fit_tracer(Tracer& tracer, const Devices& devices, uint64_t kernel_revision) {
    if (tracer.devices != devices) {
        tracer = {};
        tracer.frames = std::make_unique<MultiFrameRenderer>(devices);
        tracer.devices = devices;
    } else if (tracer.kernel_revision != kernel_revision) {
        try {
            tracer.frames = std::make_unique<MultiFrameRenderer>(devices);
        } catch (const Error& error) {
            const std::lock_guard<std::mutex> lock(mutex_);
            failure_ = error.what();
        }
    }
    tracer.kernel_revision = kernel_revision;
}

// What a sample of a side is traced with: with motion blur, the scene at a time of its own.
MotionBlur::Sample FrameThread::sample_of(Tracer& tracer, const FrameJob& job, const ReadySide& side,
                                          const OnDevices& on_devices, unsigned sample, Progress& progress) {
    if (!(job.open_s > 0) || !job.ready->blur_source || !job.ready->request.pose.time_s) {
        tracer.blur.reset();
        tracer.blur_of.reset();
        return {on_devices.prepared, std::make_shared<View>(job.view), 0};
    }
    const Shutter shutter = {*job.ready->request.pose.time_s, job.open_s, static_cast<unsigned>(job.settings.spp)};
    if (!tracer.blur || tracer.blur_of != job.ready || !(tracer.blur->shutter() == shutter)) {
        tracer.blur.reset();
        tracer.blur = std::make_unique<MotionBlur>(job.ready->blur_source(on_devices.devices, side.settings), shutter,
                                                   on_devices.prepared);
        tracer.blur_of = job.ready;
    }
    MotionBlur::Sample posed = tracer.blur->at(sample, job.view, progress);
    if (!job.camera_path.empty()) posed.view->camera = job.camera_path.at(posed.time_s);
    return posed;
}

void FrameThread::trace(const FrameJob& job, unsigned sample, bool retrace) {
    std::shared_ptr<StopProgress> progress;
    std::shared_ptr<const Picture> last, shown;
    bool distance = false, reduced = false;
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        progress = running_;
        last = traced_ ? traced_->picture : latest_;
        shown = traced_ && traced_->finished ? traced_->finished : last;
        distance = distance_;
        reduced = traced_reduced_;
    }
    const bool two = job.other_settings && job.ready->other;
    const auto on_main = job.ready->main.loan->get(), on_other = two ? job.ready->other->loan->get() : nullptr;
    if (!on_main || (two && !on_other)) return;  // withdrawn: its devices are about to be reopened
    // A picture that is only displayed again keeps the size of its film.
    float scale = job.resolution_scale;
    if (retrace) {
        const float moving = moving_scale(job);
        reduced = moving < 1;
        scale *= moving;
    }
    Traced traced;
    const auto picture = traced.picture = std::make_shared<Picture>();
    traced.fresh = retrace;
    picture->job = job;
    const auto sized = [&](const ReadySide& side, const Settings& desired_now, const PictureSide* before) {
        Settings settings = frame_settings(side.settings, desired_now);
        if (settings.denoise == "moving") settings.denoise = job.moving ? "on" : "off";
        const bool keep = !retrace && before;
        settings.width = keep ? before->settings.width : std::max(1, static_cast<int>(std::lround(settings.width * scale)));
        settings.height = keep ? before->settings.height : std::max(1, static_cast<int>(std::lround(settings.height * scale)));
        if (keep)
            settings.crop = before->settings.crop;
        else if (job.part)
            crop_picture(settings, crop_text(*job.part, settings.width, settings.height));
        return settings;
    };
    fit_tracer(tracers_[0], on_main->devices, job.ready->request.kernel_revision);
    if (two)
        fit_tracer(tracers_[1], on_other->devices, job.ready->request.kernel_revision);
    else
        tracers_[1] = {};
    if (two) finish(false);  // of the picture before, which may have had one side
    Order order;
    order.sample = sample;
    order.retrace = retrace;
    order.last = job.equal_time && retrace && sample + 1 >= unsigned(job.settings.spp);
    order.distance = distance;
    order.reference = job.reference.get();
    order.overlaps = !two;
    const PictureSide* before[2] = {last ? &last->main : nullptr, last && last->other ? &*last->other : nullptr};
    const auto side_of = [&](size_t i, const ReadySide& side, const OnDevices& on_devices, const Settings& settings) {
        const MotionBlur::Sample posed = retrace ? sample_of(tracers_[i], job, side, on_devices, sample, *progress)
                                                 : MotionBlur::Sample{on_devices.prepared, std::make_shared<View>(job.view), 0};
        return trace_side(tracers_[i], posed.prepared, sized(side, settings, before[i]), *posed.view, order, before[i],
                          *progress, traced.image);
    };
    picture->main = side_of(0, job.ready->main, *on_main, job.settings);
    double ms = picture->main.frame_ms;
    if (two) {
        if (job.equal_time && sample > 0) {
            order.sample = tracers_[1].samples;
            order.until_s = tracers_[0].convergence.seconds();
            order.retrace = retrace && tracers_[1].convergence.seconds() < order.until_s;
        }
        picture->other = side_of(1, *job.ready->other, *on_other, *job.other_settings);
        ms += picture->other->frame_ms;
    }
    uint64_t& broken = picture->main.stats.not_finite;
    if (retrace && sample > 0 && last) broken += last->main.stats.not_finite;
    if (broken > 0 && job.moving_fps <= 0 && std::exchange(told_revision_, job.revision) != job.revision)
        log(LogLevel::error, not_finite_text(broken) + ". There may be more in the samples to come");
    picture->job.settings = picture->main.settings;
    picture->reduced = reduced;
    const bool same = shown && retrace && shown->job.revision == job.revision && shown->job.ready == job.ready &&
                      shown->job.display_revision == job.display_revision && shown->reduced == reduced &&
                      shown->other.has_value() == two;
    if (same && shown->main.stats.samples > picture->main.stats.samples) traced.finished = shown;
    const bool pending = static_cast<bool>(traced.image);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        traced_ = std::move(traced);
        traced_revision_ = job.revision;
        shown_revision_ = job.display_revision;
        if (retrace) {
            traced_reduced_ = reduced;
            samples_ = sample + 1;
        }
    }
    if (retrace) {
        // The first frame of a program is slower than the later ones, so it does not count.
        const double pixels = double(picture->main.settings.width) * picture->main.settings.height;
        ms_per_pixel_ = paced_ && (paced_ == job.ready || traces_alike(*paced_, *job.ready)) ? ms / pixels : 0;
        paced_ = job.ready;
    }
    if (!pending) finish(false);
}

}  // namespace clarity::ui
