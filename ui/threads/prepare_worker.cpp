#include "ui/threads/prepare_worker.hpp"

#include <algorithm>
#include <chrono>

#include "base/elapsed.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "launch/prepared.hpp"
#include "ui/threads/thread_priority.hpp"

namespace clarity::ui {

using Clock = std::chrono::steady_clock;

namespace {

// For the thread that traces. What it holds is its own, because the preparing thread works meanwhile.
MotionBlur::Source blur_source(const PluginRegistry& plugins, const import::ImportOptions& options, const Ready& ready,
                               const Devices& devices, const Settings& settings) {
    struct Own {
        Own(const PluginRegistry& plugins, const import::ImportOptions& options) : sequences(plugins, options, unwatched) {}
        Progress unwatched;
        import::SequenceReader sequences;
        std::unique_ptr<MultiPreparer> preparer;
    };
    const auto own = std::make_shared<Own>(plugins, options);
    MotionBlur::Source source;
    source.rest = ready.rest;
    source.clip = ready.request.pose.clip;
    source.read = [own](const std::string& file) { return own->sequences(file); };
    source.prepare = [own, &plugins, devices, settings](std::shared_ptr<const Scene> scene, Progress& progress) {
        if (!own->preparer) own->preparer = std::make_unique<MultiPreparer>(plugins, devices);
        return own->preparer->prepare(std::move(scene), settings, progress);
    };
    return source;
}

}  // namespace

// Keeps the current stage for the window, and wakes the window at most 30 times a second.
class PrepareWorker::StageProgress : public Progress {
 public:
    StageProgress(const std::function<void()>& wake, bool only_pose) : wake_(wake), only_pose_(only_pose) {}
    void stage(const std::string& name) override {
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            stage_ = name;
            fraction_ = -1;
        }
        wake_();
    }
    bool report(float fraction) override {
        bool wake = false;
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            fraction_ = fraction;
            const auto now = Clock::now();
            if (now - woken_ > std::chrono::milliseconds(33)) {
                woken_ = now;
                wake = true;
            }
        }
        if (wake) wake_();
        return !cancelled();
    }
    Activity activity() const {
        const std::lock_guard<std::mutex> lock(mutex_);
        return {true, stage_, fraction_, only_pose_, ms_since(begin_) * 1e-3};
    }

 private:
    const std::function<void()>& wake_;
    const bool only_pose_;
    const Clock::time_point begin_ = Clock::now();
    mutable std::mutex mutex_;
    std::string stage_;
    float fraction_ = -1;
    Clock::time_point woken_{};
};

PrepareWorker::PrepareWorker(const PluginRegistry& plugins, import::ImportOptions import, Tracers tracers,
                             std::function<void()> wake)
    : plugins_(plugins),
      import_(std::move(import)),
      tracers_(std::move(tracers)),
      wake_(std::move(wake)),
      shown_(plugins, import_),
      thread_([this] { run(); }) {}

PrepareWorker::~PrepareWorker() {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        stop_ = true;
        waiting_.reset();
        if (running_) running_->cancel();
    }
    changed_.notify_all();
    thread_.join();
}

void PrepareWorker::request(PrepareRequest request) {
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        // If only settings changed, a running import goes on, and the new settings are used when it is done.
        const bool importing = files_revision_ != running_request_.files_revision;
        const bool same_source =
            request.files_revision == running_request_.files_revision && request.main.device == running_request_.main.device;
        if (running_ && !request.only_pose && !(importing && same_source)) running_->cancel();
        waiting_ = std::make_unique<PrepareRequest>(std::move(request));
    }
    changed_.notify_all();
}

void PrepareWorker::cancel() {
    const std::lock_guard<std::mutex> lock(mutex_);
    waiting_.reset();
    if (running_) running_->cancel();
}

std::vector<Outcome> PrepareWorker::take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(outcomes_, {});
}

Activity PrepareWorker::activity() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (running_) return running_->activity();
    if (waiting_) return {true, "starting", -1, waiting_->only_pose, 0};
    return {};
}

std::shared_ptr<const std::vector<DeviceInfo>> PrepareWorker::devices() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return devices_;
}

bool PrepareWorker::has_outcomes() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return !outcomes_.empty();
}

void PrepareWorker::publish(Outcome outcome) {
    outcome.lost = outcome.kind == Outcome::Kind::failed && all_lost(main_.devices);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        outcomes_.push_back(std::move(outcome));
    }
    wake_();
}

void PrepareWorker::publish_failure(const Error& error, bool files_failed) {
    Outcome outcome;
    outcome.kind = Outcome::Kind::failed;
    outcome.message = error.what();
    outcome.details = error.details();
    outcome.failure = error.failure();
    outcome.files_failed = files_failed;
    publish(std::move(outcome));
}

void PrepareWorker::list_all_devices() {
    std::vector<DeviceWarning> warnings;
    auto devices = std::make_shared<const std::vector<DeviceInfo>>(list_devices(&warnings));
    log_warnings(warnings);
    {
        const std::lock_guard<std::mutex> lock(mutex_);
        devices_ = std::move(devices);
    }
    wake_();
}

void PrepareWorker::run() {
    yield_to_window();
    for (;;) {
        PrepareRequest request;
        std::shared_ptr<StageProgress> progress;
        {
            std::unique_lock<std::mutex> lock(mutex_);
            changed_.wait(lock, [this] { return stop_ || waiting_; });
            if (stop_) return;
            request = *waiting_;
            running_request_ = request;
            waiting_.reset();
            progress = running_ = std::make_shared<StageProgress>(wake_, request.only_pose);
        }
        try {
            handle(request, *progress);
        } catch (const Cancelled&) {
            Outcome cancelled;
            cancelled.kind = Outcome::Kind::cancelled;
            publish(std::move(cancelled));
        } catch (const Error& error) {
            publish_failure(error);
        } catch (const std::exception& error) {  // bad_alloc, or an OpenCL call that failed in the driver
            publish_failure(Error(Exit::failed, std::string("preparing the picture failed: ") + error.what()));
        }
        {
            const std::lock_guard<std::mutex> lock(mutex_);
            running_.reset();
        }
        wake_();
    }
}

void PrepareWorker::handle(const PrepareRequest& request, StageProgress& progress) {
    progress.stage("looking for devices");
    if (!devices()) list_all_devices();
    // If the scene cannot be read, new settings still apply to the old scene. If a device is missing, the scene still loads.
    bool whole = true;
    const auto open = [&](const Side& side, SideState& state, const SideState& neighbour) {
        try {
            open_side(side.device, state, neighbour, progress);
        } catch (const Error& error) {
            whole = false;
            publish_failure(error);
        }
    };
    open(request.main, main_, other_);
    if (request.other)
        open(*request.other, other_, main_);
    else
        other_ = {};
    try {
        import_files(request, progress);
    } catch (const Cancelled&) {  // superseded: the next request imports the files
        throw;
    } catch (const Error& error) {
        whole = false;
        tried(request.files_revision);
        publish_failure(error, true);
    }
    if (!main_.preparer || !loaded_) return;
    shown_.update(loaded_, request);
    auto ready = std::make_shared<Ready>();
    ready->request = request;
    ready->request.main.device = main_.choice;
    static_cast<SceneFiles&>(ready->request) = *loaded_;
    ready->request.instances = shown_.instances();
    ready->request.maps = shown_.maps();
    ready->request.apart = shown_.asked_apart();
    ready->request.pose = shown_.pose();
    ready->loaded = loaded_;
    ready->rest = shown_.rest();
    ready->cameras = shown_.cameras();
    ready->lights = shown_.lights();
    ready->blur_source = [&plugins = plugins_, import = import_, of = ready.get()](const Devices& devices,
                                                                                   const Settings& settings) {
        return blur_source(plugins, import, *of, devices, settings);
    };
    prepare_sides(request, *ready, whole, progress);
    if (needs_reopen()) {
        // Preparation worked. Now repeat it on reopened devices; the compiler's cache has the programs.
        renew_devices();
        prepare_sides(request, *ready, whole, progress);
    }
    ready->scene = shown_.scene();
    ready->left_out = shown_.left_out();
    Outcome outcome;
    outcome.ready = ready;
    outcome.whole = whole;
    publish(std::move(outcome));
}

void PrepareWorker::prepare_sides(const PrepareRequest& request, Ready& ready, bool& whole, StageProgress& progress) {
    ready.main = prepare_side(main_, request.main.settings, request.frame_ms[0], progress);
    ready.other.reset();
    if (!request.other || !other_.preparer) return;
    ready.request.other->device = other_.choice;
    // If the second side cannot be prepared, the first side still changes.
    try {
        ready.other = prepare_side(other_, request.other->settings, request.frame_ms[1], progress);
    } catch (const Cancelled&) {
        throw;
    } catch (const Error& error) {
        whole = false;
        publish_failure(Error(Exit::failed, "the other side: " + std::string(error.what()), error.details()));
    }
}

ReadySide PrepareWorker::prepare_side(SideState& side, const Settings& settings, double frame_ms, StageProgress& progress) {
    const auto prepared = side.poses.prepare(*side.preparer, shown_, settings, frame_ms, progress);
    ReadySide ready = lend(side.devices, prepared);
    if (!shown_.follows()) return ready;
    ready.pose_update = side.poses.update();
    ready.is_moved = prepared->first()->is_moved;
    if (ready.is_moved) ready.moved = prepared->first()->on_device;
    return ready;
}

bool PrepareWorker::needs_reopen() const {
    return main_.preparer->needs_reopen() || (other_.preparer && other_.preparer->needs_reopen());
}

ReadySide PrepareWorker::lend(const Devices& devices, std::shared_ptr<const MultiPrepared> prepared) {
    ReadySide side(devices, std::move(prepared));
    const auto gone = [](const std::weak_ptr<DeviceLoan>& loan) { return loan.expired(); };
    loans_.erase(std::remove_if(loans_.begin(), loans_.end(), gone), loans_.end());
    loans_.push_back(side.loan);
    return side;
}

void PrepareWorker::withdraw_loans() {
    for (const std::weak_ptr<DeviceLoan>& given : loans_)
        if (const auto loan = given.lock()) loan->withdraw();
    loans_.clear();
}

// Closes the devices of both sides before it reopens any, because PoCL frees memory only with the last context of a process.
void PrepareWorker::renew_devices() {
    tracers_.release();
    const std::shared_ptr<void> resume(nullptr, [this](void*) { tracers_.resume(); });
    withdraw_loans();
    for (SideState* side : {&main_, &other_}) side->poses.leave_devices();
    main_.devices.clear();
    other_.devices.clear();
    std::vector<DeviceInfo> other;
    if (other_.preparer) other = other_.preparer->close_devices();
    main_.devices = open_devices(main_.preparer->close_devices());
    main_.preparer->open_devices(main_.devices);
    if (!other_.preparer) return;
    other_.devices = open_devices(other, main_.devices);
    other_.preparer->open_devices(other_.devices);
}

// Lets go of everything on the devices of a side.
std::vector<DeviceInfo> PrepareWorker::close_lost(SideState& side) {
    tracers_.release();
    const std::shared_ptr<void> resume(nullptr, [this](void*) { tracers_.resume(); });
    withdraw_loans();
    const bool stuck =
        std::any_of(side.devices.begin(), side.devices.end(), [](const auto& device) { return device->loss()->stuck(); });
    side.poses.lose_devices(stuck);
    side.devices.clear();
    return side.preparer->close_devices();
}

void PrepareWorker::open_side(const std::string& choice, SideState& state, const SideState& neighbour,
                              StageProgress& progress) {
    const bool lost = all_lost(state.devices);
    if (!state.devices.empty() && choice == state.choice && !lost) return;
    progress.stage("opening the device");
    const Devices open = all_lost(neighbour.devices) ? Devices() : neighbour.devices;
    if (lost) {
        const std::vector<DeviceInfo> infos = close_lost(state);
        if (choice == state.choice) {
            state.devices = open_devices(infos, open);
            state.preparer->open_devices(state.devices);
            return;
        }
    }
    Devices devices = open_devices(choose_devices(choice), open);
    state.preparer = std::make_unique<MultiPreparer>(plugins_, devices);
    state.poses.reset();
    state.devices = std::move(devices);
    state.choice = choice;
}

void PrepareWorker::import_files(const PrepareRequest& request, StageProgress& progress) {
    if (request.files_revision == files_revision_) return;
    if (loaded_ && request.files_revision == loaded_->files_revision) return tried(request.files_revision);
    if (request.files.empty()) return tried(request.files_revision);
    progress.stage("importing " + request.files.front());
    const auto begin = Clock::now();
    auto loaded = std::make_shared<ImportedScene>();
    import::ImportOptions options = import_;
    options.pictures = request.pictures;
    loaded->scene = std::make_shared<const Scene>(import::import_scene(plugins_, request.files, options, progress));
    loaded->import_ms = ms_since(begin);
    scene_edits(*loaded->scene, {});  // a file with an edit that cannot be made is not loaded
    static_cast<SceneFiles&>(*loaded) = request;
    loaded->bounds = loaded->scene->bounds();
    loaded->placed_triangles = loaded->scene->placed_triangle_count();
    const float aspect = static_cast<float>(request.main.settings.width) / static_cast<float>(request.main.settings.height);
    try {
        loaded->first_view = make_view(*loaded->scene, aspect, request.camera, request.light);
    } catch (const Error& error) {
        loaded->view_error = error.what();
        loaded->first_view = make_view(*loaded->scene, aspect);
    }
    loaded_ = std::move(loaded);
    tried(request.files_revision);
}

void PrepareWorker::tried(uint64_t files_revision) {
    const std::lock_guard<std::mutex> lock(mutex_);
    files_revision_ = files_revision;
}

}  // namespace clarity::ui
