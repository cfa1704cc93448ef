// prepared_scene.hpp -- a prepared scene as the window sees it: facts that stay valid, and a loan of what is on the devices.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "moving/follow/pose_follower.hpp"
#include "stand/motion_blur.hpp"
#include "ui/threads/desired_state.hpp"

namespace clarity {
class TraceProgram;
}

namespace clarity::ui {

// The files of a scene.
struct SceneFiles {
    std::vector<std::string> files;
    std::vector<PictureFile> pictures;  // that are read with them: the user gave them to materials
    uint64_t files_revision = 0;        // the files are imported (again) when it changes
};

// Everything that a picture needs besides the view and the settings of a frame.
struct PrepareRequest : SceneFiles, ObjectEdits {
    std::string camera, light;  // as on the command line; for the first view of newly imported files
    Side main;
    std::optional<Side> other;
    std::vector<rt_u32> apart;     // instances that are about to be moved: ascending
    uint64_t kernel_revision = 0;  // the kernels are read (again) when it changes
    PoseTime pose;
    bool only_pose = false;  // only the pose differs from the last request, so that work that has begun goes on
    // Time of the last frame of each side, which decides between refit and build. It asks for nothing by itself. 0: not known.
    std::array<double, 2> frame_ms{};
};

// An imported scene, with facts for the window. They are computed on the worker thread, so that the window does not wait.
struct ImportedScene : SceneFiles {
    std::shared_ptr<const Scene> scene;
    Bounds bounds;
    uint64_t placed_triangles = 0;
    double import_ms = 0;
    View first_view;
    std::string view_error;  // why first_view is not the one asked for: the scene has no such camera; empty: it is
};

// Open devices, and the programs and buffers on them.
struct OnDevices {
    Devices devices;
    std::shared_ptr<const MultiPrepared> prepared;
};

// A loan of OnDevices. The preparing thread withdraws it before it closes the devices. A device closes with its last user, and
// this way the pictures that the window still shows are no users. Thread-safe.
class DeviceLoan {
 public:
    explicit DeviceLoan(OnDevices lent) : lent_(std::make_shared<const OnDevices>(std::move(lent))) {}
    // Returns nullptr once withdrawn. Only for threads which FrameThread::release() or its equivalent stops: they must drop the
    // result before release() returns.
    std::shared_ptr<const OnDevices> get() const;
    bool withdrawn() const;
    // Whether all of its devices are lost (device/device_loss.hpp), and were not withdrawn yet.
    bool lost() const;
    void withdraw();

 private:
    mutable std::mutex mutex_;
    std::shared_ptr<const OnDevices> lent_;
};

// One side of a prepared picture. Its facts stay valid after its devices are closed.
struct ReadySide {
    struct Part {  // the share of one device
        DeviceInfo device;
        int lanes = 0;
    };
    ReadySide() = default;
    ReadySide(Devices devices, std::shared_ptr<const MultiPrepared> prepared);
    std::vector<DeviceInfo> devices;         // as chosen
    std::vector<Part> parts;                 // of the devices that take part; the members below are those of the first
    std::shared_ptr<const AccelData> accel;  // nullptr only if constructed without devices
    Settings settings;                       // automatic values (0) are replaced by the chosen ones
    double upload_ms = 0, compile_ms = 0;    // milliseconds; 0: shared with an earlier picture
    bool compile_cached = false;
    std::weak_ptr<const TraceProgram> program;  // of the first part
    // Of the first part, if devices have moved the structure: `accel` is as it was built.
    std::weak_ptr<const DeviceScene> moved;
    bool is_moved = false;
    uint64_t device_bytes = 0;  // of all buffers of the scene
    PoseUpdate pose_update;     // how the structure came to this pose
    std::shared_ptr<DeviceLoan> loan;
    bool uses(const DeviceInfo& device) const;                              // as a whole or in parts
    std::string devices_text() const { return device_list_text(devices); }  // as --device reads it
    std::string device_name() const { return devices_name(devices); }
};

// A prepared scene: what was asked for, and what came of it.
struct Ready {
    PrepareRequest request;
    std::shared_ptr<const ImportedScene> loaded;
    std::shared_ptr<const Scene> scene;  // what was imported, in its pose. Its own cameras and lights may be of another pose
    // The meshes whose vertices are at rest in `scene`, because devices make those of the pose; and what moves them.
    std::vector<Deformation> left_out;
    std::shared_ptr<const Scene> rest;  // what was imported, with its instances moved and hidden by the user, at rest
    std::vector<Camera> cameras;        // those of the scene, in its pose
    std::vector<Light> lights;          // likewise
    ReadySide main;
    std::optional<ReadySide> other;
    // What motion blur needs of a side with these devices and settings. Used by the thread that traces. May be empty.
    std::function<MotionBlur::Source(const Devices&, const Settings&)> blur_source;
    // Whether the kernels of both sides know the lights and surfaces of a view. If not, they are being compiled.
    bool knows(const View& view) const;
    // Whether its devices were closed. Its picture can still be shown, but not traced.
    bool withdrawn() const { return main.loan->withdrawn() || (other && other->loan->withdrawn()); }
    // Whether the devices of a side are lost, so that they have to be opened anew.
    bool lost() const { return main.loan->lost() || (other && other->loan->lost()); }
};

// What moves the vertices of a mesh that `scene` has at rest; nullptr: it has them as they are.
const Deformation* left_out(const Ready& ready, rt_u32 mesh);
// The scene with all vertices of its pose.
std::shared_ptr<const Scene> whole_scene(const Ready& ready);

// Whether both run the same programs on the same imported scene, so that their frames take about as long.
bool traces_alike(const Ready& a, const Ready& b);

}  // namespace clarity::ui
