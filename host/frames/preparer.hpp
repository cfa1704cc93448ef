// preparer.hpp -- from a scene and settings to a Prepared: builds, uploads and compiles.
//
// Rendering has two steps. Preparer::prepare() does the slow work (build, upload, compile) and returns an immutable Prepared.
// It may run on any thread while frames continue with the previous Prepared. FrameRenderer::trace() then traces samples of one
// frame with a Prepared. Two results of prepare() share everything that did not change between the calls.
#pragma once
#include <functional>
#include <memory>
#include <mutex>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "launch/prepared.hpp"
#include "plugin/registry.hpp"

namespace clarity {

class ProgramCache;

// The buffers of a structure on a device, made by others than the Preparer.
struct GivenBuffers {
    std::shared_ptr<const DeviceScene> buffers;
    bool by_device = false;  // the device has moved the structure: its nodes and leaves on the host are out of date
};

// Makes Prepared objects for one device. Thread-safe; each object runs one prepare() at a time.
class Preparer {
 public:
    Preparer(const PluginRegistry& plugins, std::shared_ptr<Device> device);
    ~Preparer();
    // Builds, uploads and compiles what has changed since the last call, and returns the result.
    // built: the result of build() for these settings, possibly made for another device. Without it, prepare() builds.
    // moved: its buffers, if they are on this device already.
    // Throws Error(failed) if the build or the upload fails, Error(kernel_build_failed) with the compiler's log in details(),
    // Error(usage) for an unknown structure, and Cancelled. The previous Prepared stays valid.
    std::shared_ptr<const Prepared> prepare(std::shared_ptr<const Scene> scene, const Settings& settings, Progress& progress,
                                            std::shared_ptr<const AccelData> built = nullptr, const GivenBuffers& moved = {});
    // Whether a structure is of the kind that these settings ask for, so that it may be passed as `built`.
    bool asks_for(const AccelData& accel, const Settings& settings) const;
    // Builds the structure alone. This needs no device.
    std::shared_ptr<const AccelData> build(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                           Progress& progress);
    // The same as a function that may be called on any thread beside everything else. It uses the plugins, and nothing of this
    // object.
    AccelBuilder builder(const Settings& settings) const;
    // Whether the caller should close the device and open it again. PoCL keeps at least 0.15 MB for each program that it has
    // compiled, and frees it only with the last context of the process. Editing kernels compiles hundreds of programs.
    bool needs_reopen() const;
    // Releases the device with all programs and buffers on it, and keeps the last structure. The device closes as soon as the
    // caller has also released its Device, every Prepared, and every FrameRenderer and Inspector. Returns the info to open a
    // new Device with. Until open_device(), prepare() throws Error(no_device).
    DeviceInfo close_device();
    void open_device(std::shared_ptr<Device> device);

 private:
    // settings: of a structure that is there.
    std::shared_ptr<const AccelData> build_or_last(const std::shared_ptr<const Scene>& scene, const Settings& settings,
                                                   Progress& progress);
    const PluginRegistry& plugins_;
    const DeviceInfo info_;
    std::shared_ptr<Device> device_;          // nullptr: closed
    std::unique_ptr<ProgramCache> programs_;  // nullptr: closed
    std::shared_ptr<const Prepared> last_;    // without buffers and program after close_device()
    bool film_compiled_ = false;              // or found on disk, and tried
    bool denoiser_compiled_ = false;
    mutable std::mutex mutex_;
};

}  // namespace clarity
