// rt_device.hpp -- rt_device.h for C++: the table of the extension, and the steps of a plan.
//
//   constexpr rt_device_build kBuild = rt::device_topology(rt::file(kFiles, "my_tree_build.cl"), rt::guarded<plan>);
//   constexpr rt_extension kExtensions[] = {rt::extension(kBuild), rt::kNoMoreExtensions};
#pragma once
#include <cstring>
#include <vector>

#include "rt_device.h"
#include "rt_plugin.hpp"

namespace rt {

using PlanTopology = decltype(rt_device_build::topology);
using PlanElements = decltype(rt_device_build::elements);
using PlanPack = decltype(rt_device_build::pack);
using FindRanges = decltype(rt_device_build::ranges);
using PlanRefit = decltype(rt_device_build::refit);
constexpr rt_device_build with_kernels(rt_cl_file kernels) {
    rt_device_build build{};
    build.struct_bytes = sizeof build, build.kernels = kernels;
    return build;
}
// A builder whose trees other structures pack.
constexpr rt_device_build device_topology(rt_cl_file kernels, PlanTopology topology) {
    rt_device_build build = with_kernels(kernels);
    build.topology = topology;
    return build;
}
// A layout whose finished trees the device refits.
constexpr rt_device_build device_refit(rt_cl_file kernels, FindRanges ranges, PlanRefit refit) {
    rt_device_build build = with_kernels(kernels);
    build.ranges = ranges, build.refit = refit;
    return build;
}
// A layout that the device packs, too.
constexpr rt_device_build device_layout(rt_cl_file kernels, PlanElements elements, PlanPack pack, FindRanges ranges,
                                        PlanRefit refit) {
    rt_device_build build = device_refit(kernels, ranges, refit);
    build.elements = elements, build.pack = pack;
    return build;
}
constexpr rt_extension extension(const rt_device_build& data) {
    return {RT_DEVICE_BUILD, RT_DEVICE_BUILD_VERSION, sizeof data, &data};
}

// Adds steps to a plan until one fails; the host has then recorded why. Without an exception: `return steps.result();`.
class DeviceSteps {
 public:
    explicit DeviceSteps(const rt_device_plan* plan) : plan_(plan) {}
    rt_u32 buffer(uint64_t bytes) {
        const rt_u32 made = ok_ ? plan_->buffer(plan_->ctx, bytes) : RT_NONE;
        ok_ = ok_ && made != RT_NONE;
        return made;
    }
    void launch(const char* kernel, uint64_t groups, const std::vector<rt_device_arg>& args) {
        step(plan_->launch, kernel, static_cast<rt_u32>(groups), args.data(), static_cast<rt_u32>(args.size()));
    }
    void fill(rt_u32 buffer, uint64_t words, rt_u32 value) { step(plan_->fill, buffer, words, value); }
    void sort(rt_u32 keys, rt_u32 values, uint64_t count, rt_u32 bits) { step(plan_->sort, keys, values, count, bits); }
    void scan(rt_u32 data, uint64_t count) { step(plan_->scan, data, count); }
    void bounds(rt_u32 boxes, uint64_t count, rt_u32 result) { step(plan_->bounds, boxes, count, result); }
    rt_u32 blocks(rt_u32 boxes, rt_u32 order, uint64_t count) {
        const rt_u32 made = ok_ ? plan_->blocks(plan_->ctx, boxes, order, count) : RT_NONE;
        ok_ = ok_ && made != RT_NONE;
        return made;
    }
    void curve(rt_u32 boxes, uint64_t count, rt_u32 axis_bits, rt_u32 keys, rt_u32 order) {
        step(plan_->curve, boxes, count, axis_bits, keys, order);
    }
    int32_t result() const { return ok_ ? RT_OK : RT_FAILED; }

 private:
    template <class Call, class... Args>
    void step(Call call, Args... args) {
        if (ok_) ok_ = call(plan_->ctx, args...) == RT_OK;
    }
    const rt_device_plan* const plan_;
    bool ok_ = true;
};

// Arguments of kernels: a buffer, a uint, a float.
inline rt_device_arg of(rt_u32 buffer) {
    return {buffer, 0};
}
inline rt_device_arg number(uint64_t value) {
    return {RT_NONE, static_cast<rt_u32>(value)};
}
inline rt_device_arg real(float value) {
    rt_device_arg arg{RT_NONE, 0};
    std::memcpy(&arg.value, &value, sizeof value);
    return arg;
}

// The elements that a work-group takes in kernels that do the same for each: one for each work-item, or many where a work-item
// does a group's work.
inline uint64_t elements_each(const rt_device_plan* plan) {
    return plan->group_items > 1 ? plan->group_items : 4096;
}

}  // namespace rt
