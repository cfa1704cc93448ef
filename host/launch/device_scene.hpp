// device_scene.hpp -- the device buffers of a scene in one structure.
#pragma once
#include <CL/opencl.hpp>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "device/device.hpp"
#include "kernels/kernel_arguments.hpp"
#include "scene/motion/pose.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"

namespace clarity {

// Immutable. On a CPU the buffers are the host's own memory, and this object keeps that memory alive. Always in a shared_ptr.
class DeviceScene : public std::enable_shared_from_this<DeviceScene> {
 public:
    // Uploads piece by piece and reports progress. Throws Error(failed) with the sizes if the scene does not fit, and
    // Cancelled.
    DeviceScene(Device& device, std::shared_ptr<const Scene> scene, std::shared_ptr<const AccelData> accel, Progress& progress);
    // The same scene in another pose, with a refit of its structure. Shares with `still` what no pose moves: materials,
    // textures, numbers of vertices. deformed: the meshes with other normals; none of them is flattened.
    DeviceScene(Device& device, std::shared_ptr<const DeviceScene> still, std::shared_ptr<const AccelData> accel,
                const std::vector<PosedMesh>& deformed, Progress& progress);
    ~DeviceScene();

    // The buffers that differ from pose to pose where a scene moves on the device.
    struct Moving {
        cl::Buffer leaves, instances, normals;
        std::vector<cl::Buffer> slots;  // without those of the host
        cl::Buffer bounds;              // of everything but planes: 6 floats. Null: frames have them from the host
        cl::Buffer roots;               // of the groups' trees, the world's first: uints. Null as `bounds`
    };
    // The same scene with other buffers. All others are shared.
    DeviceScene(const DeviceScene& at_rest, Moving moving);
    Moving moving() const;
    // Polygons, their corners, and triangles as numbers of vertices (rt_triangle; empty if nothing shades by them).
    struct Fixed {
        const cl::Buffer &polygons, &polygon_corners, &triangles;
    };
    Fixed fixed() const;
    bool has_triangles() const { return has_triangles_; }

    // Writes bounds and root into `count` rt_frame, if the host does not know them.
    void complete(Queue& queue, const cl::Buffer& frames, size_t count) const;
    // Sets the kernel's scene arguments. `lights` comes from the frame. If given, `materials` and `layers` replace the scene's.
    void bind(KernelArguments& kernel, const cl::Buffer& lights, const cl::Buffer* materials = nullptr,
              const cl::Buffer* layers = nullptr) const;
    uint64_t bytes() const { return bytes_; }

 private:
    std::shared_ptr<const DeviceLoss> loss_;    // of the device
    std::shared_ptr<const DeviceScene> still_;  // whose buffers this one shares
    std::shared_ptr<const Scene> scene_;
    std::shared_ptr<const AccelData> accel_;
    std::vector<rt_material> materials_;
    std::vector<rt_layers> layers_;
    std::vector<rt_u32> material_maps_;  // RT_MAP_USES for each material
    std::vector<rt_texture> textures_;
    std::vector<rt_triangle> attributes_;
    std::vector<rt_u32> tangents_;  // three for each of attributes_
    std::vector<float> normals_;    // replace the scene's normals if meshes were flattened
    // Those of the table in scene_buffers.hpp that the scene has, but for lights, by the names of their arguments.
    std::map<std::string, cl::Buffer> buffers_;
    std::vector<cl::Buffer> slots_;  // those that devices have, in the plugin's order
    std::vector<std::string> slot_arguments_;
    cl::Buffer bounds_, roots_;  // of Moving
    bool has_triangles_ = false;
    uint64_t bytes_ = 0;
};

}  // namespace clarity
