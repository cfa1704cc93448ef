// prepared.hpp -- what the slow steps before a frame produce: a scene, its structure, its buffers on a device, and the kernels.
#pragma once
#include <memory>

#include "kernels/kernel_source.hpp"
#include "kernels/layout.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"
#include "view/settings/settings.hpp"
#include "view/view.hpp"

namespace clarity {

class DeviceScene;   // the buffers of one scene in one structure
class TraceProgram;  // the compiled kernels of one specialisation

// Everything that kernels need to trace a scene. Immutable. It keeps its device open and the scene's buffers on it allocated:
// see Preparer::close_device().
struct Prepared {
    std::shared_ptr<const Scene> scene;
    std::shared_ptr<const AccelData> accel;
    std::shared_ptr<const DeviceScene> on_device;
    bool is_moved = false;  // a device has moved the structure since its build: accel's nodes and leaves are out of date
    std::shared_ptr<const TraceProgram> program;
    Settings settings;                     // as asked for; what was automatic is resolved
    Layout layout;                         // follows from these settings on this device
    double compile_ms = 0, upload_ms = 0;  // 0 if the result is shared with an earlier Prepared
    bool compile_cached = false;           // the program was compiled for an earlier Prepared
    // Whether the kernels know all lights and surfaces of a view. Else prepare() with optics_of() the view in the settings.
    bool knows(const View& view) const;
    uint64_t device_bytes() const;  // of all buffers of the scene
    // Throws Error(failed) if they do not.
    void expect_known(const View& view) const;
};

// Returns the source of a kernel. The scene, accel, settings and layout must be set; the program need not.
inline KernelSource kernel_for(const Prepared& prepared, const KernelRow& row) {
    return kernel_for(row, prepared.settings, prepared.layout, *prepared.scene, *prepared.accel);
}

}  // namespace clarity
