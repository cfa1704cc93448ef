// device_structure.hpp -- one copy of a structure on the device that traces it. Its trees are refitted or built there, one
// group at a time.
//
// The host only enqueues: leaves follow vertices and transforms (cl/build/move.cl), blocks of neighbouring leaves give boxes
// (cl/build/blocks.h), kernels of the layout write them into its nodes (rt_device_build::refit). A build lets the builder plan
// a tree over the boxes, and the layout its nodes; then the leaves are put in order. Nothing comes back but the expected costs
// of rays, some frames later.
#pragma once
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "render/moving/on_device/device_groups.hpp"

namespace clarity {

class DeviceStructure {
 public:
    // Takes memory for a copy, and fills it with the structure as it was built.
    explicit DeviceStructure(const DeviceGroups& groups);

    // Moves the leaves of a group to the pose, and refits its tree; with_cost: DevicePose::costs gets the cost of the group.
    // Group 0 comes after the groups of its instances. Only enqueues.
    void refit(rt_u32 group, bool with_cost);
    // The same, but the tree is built anew.
    void build(rt_u32 group, bool with_cost);
    // Takes the tree of a group, with its leaves, from another copy.
    void take_tree(rt_u32 group, const DeviceStructure& from);
    // Takes the normals of a mesh's vertices from the pose. Only enqueues.
    void take_normals(rt_u32 first_vertex, rt_u32 vertex_count);

    const std::shared_ptr<const DeviceScene>& on_device() const { return scene_; }
    // Defines that builds on the device have asked for.
    const std::map<std::string, rt_u32>& defines() const { return defines_; }
    const std::vector<rt_u32>& roots() const { return roots_; }

    // For the owner: of each group the move that it has followed, and that in which its tree was built; 0: none.
    std::vector<uint64_t> version, built_in;

 private:
    struct Plans {
        std::unique_ptr<DevicePlan> refit, refit_built, build, cost, cost_built;  // nullptr: not made yet
    };
    rt_device_tree tree_of(rt_u32 group, bool built, DevicePlan& plan, std::vector<rt_u32>& slots) const;
    void add_leaves(rt_u32 group, DevicePlan& plan) const;
    std::unique_ptr<DevicePlan> plan_refit(rt_u32 group, bool built) const;
    std::unique_ptr<DevicePlan> plan_build(rt_u32 group);
    std::unique_ptr<DevicePlan> plan_cost(rt_u32 group, bool built) const;
    void set_root(rt_u32 group, bool built);
    void add_cost(rt_u32 group);

    const DeviceGroups& groups_;
    DeviceScene::Moving buffers_;
    cl::Buffer ranges_;
    std::shared_ptr<const DeviceScene> scene_;
    std::vector<rt_u32> roots_;        // of each group; buffers_.roots on the device
    std::vector<uint8_t> is_built_;    // of each group: by the device
    std::vector<rt_u32> built_roots_;  // where a tree that the device builds has its root
    std::map<std::string, rt_u32> defines_;
    std::vector<Plans> plans_;  // of each group
};

}  // namespace clarity
