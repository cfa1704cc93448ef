// device_groups.hpp -- refits the trees of a structure on the device that traces it, one group at a time.
//
// The host only enqueues: leaves follow vertices and transforms (cl/build/move.cl), blocks of neighbouring leaves give boxes
// (cl/build/blocks.h), the layout's own kernels write them into its nodes (rt_device_build::refit). Nothing comes back but the
// expected costs of rays, some frames later.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "render/accel/accel_build.hpp"
#include "render/device_build/build_kernels.hpp"
#include "render/device_build/device_plan.hpp"
#include "render/frame/device_scene.hpp"
#include "rt_device.h"

namespace clarity {

// Where an instance is, as kernels read it: rt_placement of move.cl.
struct DevicePlacement {
    float world_from_object[12], object_from_world[12];
    uint32_t hidden, pad[3];
};

// Buffers that all structures of a scene share while it moves. They hold the newest pose.
struct DevicePose {
    cl::Buffer positions;          // 3 floats a vertex of the Scene, in the space of its group
    cl::Buffer normals;            // likewise; as DeviceScene has them
    cl::Buffer corners;            // rt_triangle for each ref
    cl::Buffer placements;         // DevicePlacement for each instance of the structure
    cl::Buffer group_of_instance;  // uint
    cl::Buffer group_boxes;        // 6 floats for each group
    cl::Buffer costs;              // a float for each group: expected cost of a ray
};

// One copy of what differs from pose to pose, with the steps that refit it.
class DeviceStructure;

// What all copies have in common. Used from one thread at a time.
class DeviceGroups {
 public:
    // built: the structure of `on_device`. Throws Error if kernels cannot be compiled, or memory is missing.
    DeviceGroups(const BuildKernels& kernels, std::shared_ptr<const AccelData> built,
                 std::shared_ptr<const DeviceScene> on_device, const DevicePose& pose);

    // Why the structure cannot be refitted on this device; empty: it can.
    const std::string& cannot() const { return cannot_; }
    uint64_t primitives(rt_u32 group) const { return groups_[group].count; }

 private:
    friend class DeviceStructure;
    // The tree of a group in the slots, and its leaves.
    struct Group {
        uint64_t first_element = 0, element_count = 0;  // of slot 0
        rt_u32 first_leaf = 0;
        uint64_t count = 0;  // primitives
    };
    std::string find_groups();
    void make_scratch();

    const BuildKernels& kernels_;
    const std::shared_ptr<const AccelData> built_;
    const std::shared_ptr<const DeviceScene> on_device_;
    const DevicePose& pose_;
    const rt_device_build layout_;
    const ParameterValues params_;
    std::string cannot_;
    std::vector<Group> groups_;
    cl::Program program_;                            // move.cl
    cl::Buffer ranges_;                              // rt_device_tree::ranges
    cl::Buffer boxes_, blocks_, node_costs_, sums_;  // of one group at a time
};

class DeviceStructure {
 public:
    // Takes memory for a copy, and fills it with the structure as it was built.
    explicit DeviceStructure(const DeviceGroups& groups);

    // Moves the leaves of a group to the pose, and refits its tree. Group 0 comes after the groups of its instances. Only
    // enqueues.
    void refit(rt_u32 group);
    // Takes the normals of a mesh's vertices from the pose. Only enqueues.
    void take_normals(rt_u32 first_vertex, rt_u32 vertex_count);

    const std::shared_ptr<const DeviceScene>& on_device() const { return scene_; }
    std::vector<uint64_t> version;  // of each group: the move that it has followed; 0: none. For the owner

 private:
    std::unique_ptr<DevicePlan> plan(rt_u32 group);

    const DeviceGroups& groups_;
    DeviceScene::Moving buffers_;
    std::shared_ptr<const DeviceScene> scene_;
    std::vector<std::unique_ptr<DevicePlan>> plans_;  // of each group; nullptr: not made yet
};

}  // namespace clarity
