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
#include "device/device.hpp"
#include "import/import.hpp"
#include "render/multi_preparer.hpp"
#include "ui/wish.hpp"

namespace clarity {

// All that a picture needs besides view and frame settings.
struct PrepareRequest {
    std::vector<std::string> files;
    uint64_t files_revision = 0;  // a new number: import (again)
    std::string camera, light;    // as on the command line, for the first view of newly imported files
    Side main;
    std::optional<Side> other;
    std::vector<rt_u32> hidden;    // instances
    uint64_t kernel_revision = 0;  // a new number: kernels are read (again)
};

// A scene as imported, with what the window asks about it, computed where it does not hold up the window.
struct LoadedScene {
    std::shared_ptr<const Scene> scene;
    std::vector<std::string> files;
    uint64_t files_revision = 0;
    Bounds bounds;
    uint64_t placed_triangles = 0;
    double import_ms = 0;
    View first_view;
    std::string view_error;  // why it is not the one asked for: a camera that the scene does not have
};

struct ReadySide {
    ReadySide() = default;
    ReadySide(Devices chosen, std::shared_ptr<const MultiPrepared> what)
        : devices(std::move(chosen)),
          shared(std::move(what)),
          device(shared->parts.front().device),
          prepared(shared->first()) {}
    Devices devices;
    std::shared_ptr<const MultiPrepared> shared;
    std::shared_ptr<Device> device;                                                   // the first that takes part,
    std::shared_ptr<const Prepared> prepared;                                         // and what it has
    bool uses(const DeviceInfo& device) const;                                        // whole or in parts
    std::string devices_text() const { return device_list_text(infos_of(devices)); }  // as --device reads it
    std::string device_name() const { return devices_name(infos_of(devices)); }
};

struct Ready {
    PrepareRequest request;
    std::shared_ptr<const LoadedScene> loaded;
    ReadySide main;
    std::optional<ReadySide> other;
};

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
    // Those who trace on the devices that are opened here, in words to and fro.
    struct Tracers {
        std::function<void()> release, resume;  // let go of everything on a device; go on
    };
    // wake: called from the worker whenever there is news.
    PrepareWorker(const PluginRegistry& plugins, ImportOptions import, Tracers tracers, std::function<void()> wake);
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
    struct Workshop {
        Devices devices;
        std::string choice;
        std::unique_ptr<MultiPreparer> preparer;
    };
    void prepare_sides(const PrepareRequest& request, Ready& ready, bool& whole, StageProgress& progress);
    bool worn() const;
    void renew_devices();
    void open_side(const std::string& choice, Workshop& shop, const Workshop& neighbour, StageProgress& progress);
    void import_files(const PrepareRequest& request, StageProgress& progress);
    void hide(const PrepareRequest& request);
    void list_all_devices();
    void tried(uint64_t files_revision);  // whatever came of it, it is not imported again
    void publish(Outcome outcome);

    const PluginRegistry& plugins_;
    const ImportOptions import_;
    const Tracers tracers_;
    const std::function<void()> wake_;

    // Of the worker thread alone.
    Workshop main_, other_;
    std::shared_ptr<const LoadedScene> loaded_;
    std::shared_ptr<const Scene> visible_;  // visible_of_ without what is hidden
    std::shared_ptr<const LoadedScene> visible_of_;
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

}  // namespace clarity
