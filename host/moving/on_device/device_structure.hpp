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

#include "base/problem.hpp"
#include "launch/device_scene.hpp"
#include "rt_device.h"
#include "structures/accel_build.hpp"
#include "structures/on_device/build_kernels.hpp"
#include "structures/on_device/device_plan.hpp"

namespace clarity {

// The groups of a structure whose trees are refitted or built on the device that traces it: where they
// are, and what all copies of the structure share.

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
    cl::Buffer group_boxes;        // rt_block for each group
    cl::Buffer no_bounds;          // 6 floats: +inf, then -inf
    cl::Buffer costs;              // a float for each group: expected cost of a ray
};

// What all copies have in common. Used from one thread at a time.
class DeviceGroups {
 public:
    // built: the structure of `on_device`. Throws Error if kernels cannot be compiled, or memory is missing.
    DeviceGroups(const BuildKernels& kernels, std::shared_ptr<const AccelData> built,
                 std::shared_ptr<const DeviceScene> on_device, const DevicePose& pose);

    // Why the structure cannot be refitted on this device; nothing: it can.
    const Problem& cannot() const { return cannot_; }
    // Whether its trees can be built there, too: by the structure's own builder.
    bool can_build() const { return builder_.topology && layout_.pack && layout_.elements; }
    uint64_t primitives(rt_u32 group) const { return groups_[group].count; }
    size_t count() const { return groups_.size(); }

 private:
    friend class DeviceStructure;
    static constexpr uint64_t kCostGroups = 512;  // work-groups that add costs, at most
    // Where a tree is in the slots: of each slot of the table, the first element and how many there are.
    struct Place {
        std::vector<uint64_t> first, count;
    };
    struct Group {
        Place at_rest;  // of the tree that the host has built; slot 0 alone
        Place built;    // for the tree that the device builds
        rt_u32 first_leaf = 0;
        uint64_t count = 0;  // primitives
    };
    Problem find_groups();
    void place_trees();
    void make_scratch();

    const BuildKernels& kernels_;
    const std::shared_ptr<const AccelData> built_;
    const std::shared_ptr<const DeviceScene> on_device_;
    const DevicePose& pose_;
    const rt_device_build layout_, builder_;  // builder_: without functions if the host builds for this layout itself
    const ParameterValues params_;
    Problem cannot_;
    std::vector<Group> groups_;
    cl::Program program_;                  // move.cl
    cl::Buffer ranges_;                    // rt_device_tree::ranges of the structure as it was built
    std::vector<uint64_t> slot_elements_;  // of each slot of the table, with room for trees that the device builds
    // Of one group at a time.
    cl::Buffer blocks_, node_costs_, sums_;
    cl::Buffer boxes_, order_, old_leaves_;  // for builds
};

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
