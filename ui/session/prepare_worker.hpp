// prepare_worker.hpp -- the thread that does what is slow: listing and opening devices, import, build, upload, compile.
#pragma once
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/progress.hpp"
#include "import/import.hpp"
#include "ui/session/prepared_scene.hpp"

namespace clarity::ui {

struct Outcome {
    enum class Kind { ready, failed, cancelled };
    Kind kind = Kind::ready;
    std::shared_ptr<const Ready> ready;
    std::string message, details;  // of a failure
    bool files_failed = false;     // it was the import
    bool whole = false;            // ready, and nothing of the request failed on the way
};

struct Activity {
    bool busy = false;
    std::string stage;
    float fraction = -1;  // negative: unknown
};

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

    // The newest request wins; work that it makes useless is cancelled.
    void request(PrepareRequest request);
    // Drops what is running and what is waiting.
    void cancel();
    std::vector<Outcome> take();
    Activity activity() const;
    std::shared_ptr<const std::vector<DeviceInfo>> devices() const;  // nullptr until they are listed

 private:
    class StageProgress;
    void run();
    void handle(const PrepareRequest& request, StageProgress& progress);
    // One side's devices and what was prepared on them.
    struct SideState {
        Devices devices;
        std::string choice;
        std::unique_ptr<MultiPreparer> preparer;
    };
    void prepare_sides(const PrepareRequest& request, Ready& ready, bool& whole, StageProgress& progress);
    bool needs_reopen() const;
    void renew_devices();
    void withdraw_loans();
    ReadySide lend(const Devices& devices, std::shared_ptr<const MultiPrepared> prepared);
    void open_side(const std::string& choice, SideState& shop, const SideState& neighbour, StageProgress& progress);
    void import_files(const PrepareRequest& request, StageProgress& progress);
    void hide(const PrepareRequest& request);
    void list_all_devices();
    void tried(uint64_t files_revision);  // whatever came of it, it is not imported again
    void publish(Outcome outcome);

    const PluginRegistry& plugins_;
    const import::ImportOptions import_;
    const Tracers tracers_;
    const std::function<void()> wake_;

    // Of the worker thread alone.
    SideState main_, other_;
    std::vector<std::weak_ptr<DeviceLoan>> loans_;  // of every side that may still be traced
    std::shared_ptr<const ImportedScene> loaded_;
    std::shared_ptr<const Scene> visible_;  // visible_of_ without what is hidden
    std::shared_ptr<const ImportedScene> visible_of_;
    std::vector<rt_u32> hidden_;
    uint64_t files_revision_ = 0;  // last one tried

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool stop_ = false;
    std::unique_ptr<PrepareRequest> waiting_;
    PrepareRequest running_request_;
    std::shared_ptr<StageProgress> running_;
    std::vector<Outcome> outcomes_;
    std::shared_ptr<const std::vector<DeviceInfo>> devices_;
    std::thread thread_;  // last: it sees the rest complete
};

}  // namespace clarity::ui
