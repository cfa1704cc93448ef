#include "tracers/rays/ray_kernels.hpp"

namespace clarity {
namespace {

// Rays that need more steps than this are long, and are traced again by many work-items. On an H200, 32 to 64 are nearly as
// good (docs/experiments.md).
constexpr unsigned kStepBudget = 48;

KernelRow row_of(const char* file, const char* entry, const std::vector<std::string>& defines = {}) {
    KernelRow row;
    row.tracer = "rays";
    row.what = "ray queries";
    row.file = file;
    row.entry = entry;
    row.headers = {"tracers/rays/ray_blocks.h"};
    row.defines = defines;
    return row;
}

KernelRow warp_row(unsigned rays_per_item) {
    KernelRow row =
        row_of("tracers/rays/warp_rays.cl", "trace_warps", {"RT_RAYS_PER_ITEM " + std::to_string(rays_per_item) + "u"});
    row.traits = kVotes;
    row.needs = RT_TRAVERSES_WARPS;
    row.rays_per_item = rays_per_item;
    return row;
}

}  // namespace

const KernelRow& plain_rays() {
    static const KernelRow row = row_of("tracers/rays/rays.cl", "trace_rays");
    return row;
}

const KernelRow& counted_rays() {
    static const KernelRow row = [] {
        KernelRow r = row_of("tracers/rays/rays.cl", "trace_rays", {"RT_COUNT_STEPS"});
        r.tracer = "counted_rays";
        return r;
    }();
    return row;
}

const KernelRow& all_hits() {
    static const KernelRow row = [] {
        KernelRow r =
            row_of("tracers/rays/all_hits.cl", "trace_all_hits", {"RT_ALL_HITS " + std::to_string(kHitsAtOnce) + "u"});
        r.tracer = "all_hits";
        r.traits = kNearestOnly | kAllHits;
        return r;
    }();
    return row;
}

const KernelRow& requeued_rays() {
    static const KernelRow row = [] {
        KernelRow r = row_of(
            "tracers/rays/requeued_rays.cl", "trace_short",
            {"RT_STEP_BUDGET " + std::to_string(kStepBudget), "RT_REQUEUE_ITEMS " + std::to_string(kRequeueItems) + "u"});
        r.needs = RT_REQUEUES_LONG_RAYS;
        return r;
    }();
    return row;
}

const KernelRow& dynamic_fetch() {
    static const KernelRow row = [] {
        KernelRow r = row_of("tracers/rays/dynamic_fetch.cl", "trace_dynamic_fetch");
        r.traits = kNearestOnly;
        r.needs = RT_TRAVERSES_STEPS;
        return r;
    }();
    return row;
}

const std::vector<const KernelRow*>& ray_kernels_of_structures() {
    static const KernelRow warp_rays = warp_row(1), warp_pairs = warp_row(2);
    static const std::vector<const KernelRow*> rows = {&requeued_rays(), &dynamic_fetch(), &warp_rays, &warp_pairs};
    return rows;
}

}  // namespace clarity
