// device_plan.hpp -- the host's side of rt_device.h: collects the steps that plugins plan, and carries them out on the device.
#pragma once
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "rt_device.h"
#include "structures/on_device/build_kernels.hpp"

namespace clarity {

// What a layout tells the host while it plans.
struct PlannedLayout {
    rt_u32 root = RT_NONE;  // element of slot 0
    std::map<std::string, rt_u32> defines;
};

// The steps of one build or refit. Plugins add steps and memory while it is made; then run() enqueues all of them, again and
// again, without an allocation. Used from one thread.
class DevicePlan {
 public:
    // `kernels` must outlive this object.
    explicit DevicePlan(const BuildKernels& kernels);
    ~DevicePlan();
    DevicePlan(const DevicePlan&) = delete;
    DevicePlan& operator=(const DevicePlan&) = delete;

    // Gives a buffer of the caller's a number that plugins name it by.
    rt_u32 add(const cl::Buffer& buffer);
    const cl::Buffer& buffer(rt_u32 number) const { return buffers_.at(number); }

    // Lets a builder plan a topology. Compiles the plugin's kernels. Throws Error(failed) "accel lbvh: why" and
    // Error(kernel_build_failed).
    rt_device_topology plan_topology(const rt_plugin& plugin, const rt_device_build& build, const rt_device_input& input);

    // Lets the layout plan the nodes of a tree. leaves: number of a buffer of a uint for each primitive.
    PlannedLayout plan_layout(const rt_plugin& plugin, const rt_device_build& build, const rt_device_input& input,
                              const rt_device_topology& topology, const rt_device_tree& tree, rt_u32 leaves);
    // Lets the layout plan the refit of a tree.
    void plan_refit(const rt_plugin& plugin, const rt_device_build& build, const rt_device_tree& tree, rt_u32 blocks,
                    rt_u32 costs, const double* params);
    // Adds a step of the host's own.
    void add_step(std::function<void()> step) { steps_.push_back(std::move(step)); }

    // Enqueues all steps on the device's queue. Throws cl::Error.
    void run();

    size_t steps() const { return steps_.size(); }
    uint64_t bytes() const { return bytes_; }  // of the memory that the plan took itself

 private:
    struct Calls;  // the functions of the table
    void plan(const rt_plugin& plugin, const rt_device_build& build,
              const std::function<int32_t(const rt_host*, const rt_device_plan*)>& call);

    const BuildKernels& kernels_;
    std::vector<cl::Buffer> buffers_;
    std::vector<std::function<void()>> steps_;
    cl::Program program_;  // of the plugin that plans now
    std::string why_;      // the first error while a plugin planned
    uint64_t bytes_ = 0;
};

}  // namespace clarity
