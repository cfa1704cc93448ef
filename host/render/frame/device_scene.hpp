// device_scene.hpp -- a scene in one structure as buffers of a device.
#pragma once
#include <CL/opencl.hpp>
#include <memory>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "render/accel/accel_build.hpp"
#include "scene/scene.hpp"

namespace clarity {

// Immutable once made. On a CPU the buffers are the host's own memory, which it keeps alive.
class DeviceScene {
 public:
    // Uploads piece by piece. Throws Error(failed) with the numbers where it does not fit, Cancelled.
    DeviceScene(Device& device, std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> accel, Progress& progress);

    // Sets the context's arguments from `first` on (see kernel_source.cpp for their order); lights come from the frame, and
    // materials where it brings its own.
    void bind(cl::Kernel& kernel, cl_uint first, const cl::Buffer& lights, const cl::Buffer* materials = nullptr) const;
    uint64_t bytes() const { return bytes_; }

 private:
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const AccelData> accel_;
    std::vector<rt_material> materials_;
    std::vector<rt_triangle> attributes_;
    std::vector<float> normals_;  // in place of the scene's, where meshes were moved
    std::vector<cl::Buffer> before_lights_, slots_;
    size_t materials_at_ = 0;  // in before_lights_
    uint64_t bytes_ = 0;
};

}  // namespace clarity
