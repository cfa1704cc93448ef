// device_run.hpp -- carries out plans of a plugin's `device_build`, with guards around what they may write.
//
// Functions return what is wrong. They throw Error if the plugin does not plan, and cl::Error if the device
// fails.
#pragma once
#include <string>
#include <vector>

#include "structures/judging.hpp"
#include "tools/check/builds/build_run.hpp"
#include "tools/check/builds/device_trees.hpp"

namespace clarity::check {

// The plan of a builder for `count` primitives.
class TopologyRun {
 public:
    TopologyRun(const BuildKernels& kernels, const rt_plugin& plugin, size_t count);
    // Builds over `prims`. leaves: receives their numbers in the order of the leaves.
    Problem run(const std::vector<rt_prim>& prims, std::vector<rt_u32>& leaves);

 private:
    const BuildKernels& kernels_;
    const ParameterValues params_;
    const size_t count_;
    DevicePlan plan_;
    cl::Buffer prims_;
    rt_device_topology tree_{};
};

// The tree of one group on the device, in slots that begin before it and end behind it.
class LayoutRun {
 public:
    // For trees over `count` primitives that the layout packs on the device, of `depth` nodes above each other.
    LayoutRun(const BuildKernels& kernels, const rt_plugin& plugin, size_t count, rt_u32 depth);
    // For one group of a finished build, whose leaves are the primitives of `order`. why: receives what is wrong with its
    // ranges.
    LayoutRun(const BuildKernels& kernels, const rt_plugin& plugin, const BuilderResult& built, rt_u32 group, Problem& why);

    // Packs a tree. leaves: receives the primitives' numbers in leaf order.
    Problem pack(const std::vector<rt_prim>& prims, const DeviceTree& tree, std::vector<rt_u32>& leaves);
    // Refits the tree. prims: in leaf order.
    Problem refit(const std::vector<rt_prim>& prims);
    // The expected cost of a ray that hits the box of the tree, by the last refit; negative: floats cannot hold the areas.
    double cost() const { return cost_; }
    // The slots with their tree, for loose_bounds(). Of one group.
    BuilderResult result() const;
    uint64_t first_leaf() const { return first_leaf_; }
    uint64_t count() const { return count_; }

 private:
    void make_slots(const BuilderResult* built);
    rt_device_tree tree_in(DevicePlan& plan, std::vector<rt_u32>& numbers) const;
    void plan_refit();
    std::vector<std::vector<unsigned char>> slots() const;
    Problem written_outside(const std::vector<std::vector<unsigned char>>& before) const;
    Problem ranges_fault() const;

    const BuildKernels& kernels_;
    const rt_plugin& plugin_;
    const rt_device_build build_;
    const ParameterValues params_;
    uint64_t count_ = 0, first_leaf_ = 0;
    rt_u32 root_ = RT_NONE;
    double cost_ = -1;
    std::vector<uint64_t> first_, elements_, all_;  // of each slot: of the tree, and with what is beside it
    std::vector<cl::Buffer> buffers_;               // of each slot; of those of the host alone nothing is sent
    cl::Buffer ranges_, prims_, nodes_, counts_, order_, root_buffer_, leaves_, leaf_prims_, costs_;
    DevicePlan pack_, refit_;
};

}  // namespace clarity::check
