#include "picture/frame_stats.hpp"

#include <algorithm>

#include "base/text.hpp"
#include "rt_types.h"

namespace clarity {
namespace {

KernelTime& time_of(std::vector<KernelTime>& times, const std::string& name) {
    for (KernelTime& time : times)
        if (time.name == name) return time;
    times.push_back({name, 0});
    return times.back();
}

}  // namespace

std::string not_finite_text(uint64_t samples) {
    return "tracing: " + plural(samples, "sample is", "samples are") +
           " not a finite number, and so are their pixels: a number of the scene is too large, or a kernel has a fault. Look "
           "for huge radiances and scales; `--only-paths` shows which light and which event they come from";
}

std::string dropped_text(uint64_t rays, int ray_slots) {
    const std::string slots =
        "because a pixel's ray slots were full: raise --ray-slots (now " + std::to_string(ray_slots) + "), or ";
    return plural(rays, "ray was", "rays were") + " dropped " + (ray_slots > 0 ? slots : "") + "because more than " +
           std::to_string(RT_MOST_PASSED) + " surfaces that are cut out lie one behind the other";
}

void add_rays(FrameStats& sum, const FrameStats& more) {
    static_cast<RayCounts&>(sum) += more;
    sum.launches += more.launches;
}

void add_stats(FrameStats& sum, const FrameStats& more) {
    static_assert(has_member_count<FrameStats, 7>, "a new member has to be summed here, or by add_shares()");
    add_rays(sum, more);
    sum.device_ms += more.device_ms;
    sum.wall_ms += more.wall_ms;
    sum.samples = std::max(sum.samples, more.samples);
    for (const KernelTime& time : more.kernels) time_of(sum.kernels, time.name).ms += time.ms;
}

void add_shares(std::vector<DeviceShare>& sum, const std::vector<DeviceShare>& more) {
    if (sum.size() != more.size()) sum.assign(more.size(), {});
    for (size_t i = 0; i < more.size(); ++i) {
        DeviceShare total = more[i];
        total.device_ms += sum[i].device_ms;
        total.wall_ms += sum[i].wall_ms;
        total.launches += sum[i].launches;
        sum[i] = total;
    }
}

void merge_times(std::vector<KernelTime>& all, const std::vector<KernelTime>& one) {
    for (const KernelTime& time : one) {
        double& ms = time_of(all, time.name).ms;
        ms = std::max(ms, time.ms);
    }
}

}  // namespace clarity
