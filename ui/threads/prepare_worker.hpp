// prepare_worker.hpp -- the thread for slow work: listing and opening devices, import, building, upload, compilation.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "import/import.hpp"
#include "ui/threads/prepared_scene.hpp"
#include "ui/threads/shown_scene.hpp"

namespace clarity::ui {

// The result of a request.
struct Outcome {
    enum class Kind { ready, failed, cancelled };
    Kind kind = Kind::ready;
    std::shared_ptr<const Ready> ready;
    std::string message, details;  // of a failure
    Failure failure = Failure::other;
    bool files_failed = false;  // the import failed
    bool whole = false;         // `ready`, and no part of the request failed
    bool lost = false;          // failed because the devices were lost, which the next request opens anew
};

// What the worker does now.
struct Activity {
    bool busy = false;
    std::string stage;
    float fraction = -1;     // negative: unknown
    bool only_pose = false;  // only another pose is prepared
    double seconds = 0;      // since this request was begun
};

// The thread. All public members may be called from any thread, and none waits.
class PrepareWorker {
 public:
    // Callbacks to the threads that trace on our devices: `release` returns when they hold nothing on a device, `resume` lets
    // them go on.
    struct Tracers {
        std::function<void()> release, resume;
    };
    // wake: called from the worker whenever there is news.
    PrepareWorker(const PluginRegistry& plugins, import::ImportOptions import, Tracers tracers, std::function<void()> wake);
    ~PrepareWorker();

    // Replaces the waiting request. Running work is cancelled if the new request makes it useless. A new pose does not: while
    // a scene moves, each pose would be cancelled by the next.
    void request(PrepareRequest request);
    // Cancels the running request and drops the waiting one.
    void cancel();
    // Returns the outcomes since the last call, oldest first.
    std::vector<Outcome> take();
    Activity activity() const;
    bool has_outcomes() const;                                       // that take() would return
    std::shared_ptr<const std::vector<DeviceInfo>> devices() const;  // nullptr until the devices are listed

 private:
    class StageProgress;
    void run();
    void handle(const PrepareRequest& request, StageProgress& progress);
    // One side's devices and its preparer.
    struct SideState {
        Devices devices;
        std::string choice;
        std::unique_ptr<MultiPreparer> preparer;
        PosePreparer poses;
    };
    // Prepares what is shown for one side. The structure follows a pose.
    ReadySide prepare_side(SideState& side, const Settings& settings, double frame_ms, StageProgress& progress);
    void prepare_sides(const PrepareRequest& request, Ready& ready, bool& whole, StageProgress& progress);
    bool needs_reopen() const;
    void renew_devices();
    std::vector<DeviceInfo> close_lost(SideState& side);
    void withdraw_loans();
    ReadySide lend(const Devices& devices, std::shared_ptr<const MultiPrepared> prepared);
    void open_side(const std::string& choice, SideState& state, const SideState& neighbour, StageProgress& progress);
    void import_files(const PrepareRequest& request, StageProgress& progress);
    void list_all_devices();
    void tried(uint64_t files_revision);  // notes that these files need no further import, even if this one failed
    void publish(Outcome outcome);
    void publish_failure(const Error& error, bool files_failed = false);

    const PluginRegistry& plugins_;
    const import::ImportOptions import_;
    const Tracers tracers_;
    const std::function<void()> wake_;

    // Used by the worker thread only.
    SideState main_, other_;
    std::vector<std::weak_ptr<DeviceLoan>> loans_;  // of every side that may still be traced
    std::shared_ptr<const ImportedScene> loaded_;
    ShownScene shown_;
    uint64_t files_revision_ = 0;  // of the last files that were imported, even if that failed

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    std::unique_ptr<PrepareRequest> waiting_;
    PrepareRequest running_request_;
    std::shared_ptr<StageProgress> running_;
    std::vector<Outcome> outcomes_;
    std::shared_ptr<const std::vector<DeviceInfo>> devices_;
    std::thread thread_;  // last member: the thread starts when all others exist
};

}  // namespace clarity::ui
