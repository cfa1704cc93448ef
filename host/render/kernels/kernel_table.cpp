#include "render/kernels/kernel_table.hpp"

#include <map>
#include <stdexcept>

namespace clarity {
namespace {

bool is_part(const KernelChoice& choice) {
    return choice.part < FramePart::whole;
}
bool is_wavefront(const KernelChoice& choice) {
    return choice.settings.tracer == "wavefront";
}
// Whether each work-item computes one pixel. Only GPUs have such layouts.
bool is_one_pixel(const KernelChoice& choice) {
    return choice.layout.max_pixels == 1 && choice.layout.lanes == 1;
}

using Headers = std::vector<const char*>;

// Trace a packet's rays one generation after the other, in arrays of private memory.
const Headers kByGenerations = {"shading/material.h", "tracers/iterative/ray_queue.h", "tracers/inspect/recorder.h",
                                "shading/shading.h", "tracers/iterative/generations.h"};
// The same for one pixel a work-item: there rays that do not split need no array.
const Headers kOnePixel = {"shading/material.h",         "tracers/iterative/ray_queue.h",
                           "tracers/inspect/recorder.h", "shading/shading.h",
                           "tracers/ray_step.h",         "tracers/iterative/iterative_single.h"};
// Trace all rays of a frame, in queues of global memory.
const Headers kByQueues = {"shading/material.h", "shading/shading.h", "tracers/ray_step.h", "lanes/work_distribution.h",
                           "tracers/wavefront/wavefront_rays.h"};
const Headers kRayBlocks = {"tracers/rays/ray_blocks.h"};

// Rays that need more steps than this are long, and are traced again by many work-items. On an H200, 32 to 64 are nearly as
// good (docs/experiments.md).
constexpr unsigned kStepBudget = 48;
const std::vector<std::string> kRequeue = {"RT_STEP_BUDGET " + std::to_string(kStepBudget),
                                           "RT_REQUEUE_ITEMS " + std::to_string(kRequeueItems) + "u"};

}  // namespace

const std::vector<KernelRow>& kernel_table() {
    using K = KernelKind;
    constexpr unsigned kFrame = kRaySlots | kLimitRegisters;
    // clang-format off
    static const std::vector<KernelRow> table = {
        // kind, applies, what
        //     file, entry, headers, defines, traits, needs, rays_per_item
        {K::color, is_part, "a part of a frame",
            "tracers/frame_parts.cl", "trace_parts", kByGenerations, {}, kFrame, 0, 0},
        {K::color, is_wavefront, "tracer wavefront",
            "tracers/wavefront/wavefront.cl", "trace_wavefront", kByQueues, {}, kLimitRegisters | kFrameQueues, 0, 0},
        {K::color, is_one_pixel, "tracer iterative",
            "tracers/iterative/iterative.cl", "trace_iterative", kOnePixel, {}, kFrame, 0, 0},
        {K::color, nullptr, "tracer iterative",
            "tracers/iterative/iterative.cl", "trace_iterative", kByGenerations, {}, kFrame, 0, 0},
        {K::generations, nullptr, "tracer iterative",
            "tracers/iterative/iterative.cl", "trace_iterative", kByGenerations, {"RT_SHOW_GENERATIONS"}, kRaySlots, 0, 0},
        {K::aov, nullptr, "tracer of AOVs",
            "tracers/aov/aov.cl", "trace_aov", {}, {}, kNearestOnly | kReadsUvs, 0, 0},
        {K::rays, nullptr, "ray queries",
            "tracers/rays/rays.cl", "trace_rays", kRayBlocks, {}, 0, 0, 0},
        {K::counted_rays, nullptr, "ray queries",
            "tracers/rays/rays.cl", "trace_rays", kRayBlocks, {"RT_COUNT_STEPS"}, 0, 0, 0},
        {K::requeued_rays, nullptr, "ray queries",
            "tracers/rays/requeued_rays.cl", "trace_short", kRayBlocks, kRequeue, 0, RT_REQUEUES_LONG_RAYS, 0},
        {K::dynamic_fetch, nullptr, "ray queries",
            "tracers/rays/dynamic_fetch.cl", "trace_dynamic_fetch", kRayBlocks, {}, kNearestOnly, RT_TRAVERSES_STEPS, 0},
        {K::warp_rays, nullptr, "ray queries",
            "tracers/rays/warp_rays.cl", "trace_warps", kRayBlocks, {"RT_RAYS_PER_ITEM 1u"}, kVotes, RT_TRAVERSES_WARPS, 1},
        {K::warp_pairs, nullptr, "ray queries",
            "tracers/rays/warp_rays.cl", "trace_warps", kRayBlocks, {"RT_RAYS_PER_ITEM 2u"}, kVotes, RT_TRAVERSES_WARPS, 2},
        {K::inspect, nullptr, "inspector",
            "tracers/inspect/inspect.cl", "trace_inspect", kByGenerations, {"RT_INSPECT", "RT_COUNT_STEPS"}, kRaySlots, 0, 0},
    };
    // clang-format on
    return table;
}

const KernelRow& kernel_row(const KernelChoice& choice) {
    for (const KernelRow& row : kernel_table())
        if (row.kind == choice.kind && (!row.applies || row.applies(choice))) return row;
    throw std::logic_error("a kind of kernel has no row in kernel_table.cpp");
}

}  // namespace clarity
