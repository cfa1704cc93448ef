// prepared_scene.hpp -- a prepared picture as the window knows it: facts that stay, and what is on the devices, on loan.
#pragma once
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "render/multi/multi_preparer.hpp"
#include "ui/session/desired_state.hpp"

namespace clarity::ui {

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
struct ImportedScene {
    std::shared_ptr<const Scene> scene;
    std::vector<std::string> files;
    uint64_t files_revision = 0;
    Bounds bounds;
    uint64_t placed_triangles = 0;
    double import_ms = 0;
    View first_view;
    std::string view_error;  // why it is not the one asked for: a camera that the scene does not have
};

// Open devices, and the programs and buffers on them.
struct OnDevices {
    Devices devices;
    std::shared_ptr<const MultiPrepared> prepared;
};

// A loan of OnDevices. The preparing thread withdraws it before it closes the devices: a device closes with its last user, and
// pictures that the window still shows are not to count among them. Thread-safe.
class DeviceLoan {
 public:
    explicit DeviceLoan(OnDevices lent) : lent_(std::make_shared<const OnDevices>(std::move(lent))) {}
    // nullptr once withdrawn. For threads that FrameThread::release() and its like stop; they drop the result before that ends.
    std::shared_ptr<const OnDevices> get() const;
    bool withdrawn() const;
    void withdraw();

 private:
    mutable std::mutex mutex_;
    std::shared_ptr<const OnDevices> lent_;
};

// One side of a picture. The facts stay valid when its devices are closed.
struct ReadySide {
    struct Part {  // what one device has of it
        DeviceInfo device;
        int lanes = 0;
    };
    ReadySide() = default;
    ReadySide(Devices devices, std::shared_ptr<const MultiPrepared> prepared);
    std::vector<DeviceInfo> devices;         // as chosen
    std::vector<Part> parts;                 // of those that take part; what follows is of the first
    std::shared_ptr<const AccelData> accel;  // nullptr only if constructed without devices
    Settings settings;                       // with 0 = automatic resolved
    double upload_ms = 0, compile_ms = 0;    // 0: shared with an earlier picture
    bool compile_cached = false;
    uint64_t device_bytes = 0;  // of all buffers of the scene
    std::shared_ptr<DeviceLoan> loan;
    bool uses(const DeviceInfo& device) const;                              // whole or in parts
    std::string devices_text() const { return device_list_text(devices); }  // as --device reads it
    std::string device_name() const { return devices_name(devices); }
};

struct Ready {
    PrepareRequest request;
    std::shared_ptr<const ImportedScene> loaded;
    ReadySide main;
    std::optional<ReadySide> other;
    // Whether its devices were closed: it can be shown, but not traced.
    bool withdrawn() const { return main.loan->withdrawn() || (other && other->loan->withdrawn()); }
};

}  // namespace clarity::ui
