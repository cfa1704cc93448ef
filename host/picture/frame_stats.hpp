// frame_stats.hpp -- times and ray counts of a frame, and their sums over several samples or several devices.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "base/members.hpp"
#include "device/kernel_time.hpp"

namespace clarity {

// What kernels count while they trace samples.
struct RayCounts {
    uint64_t primary = 0, shadow = 0, secondary = 0, dropped = 0;  // rays; all but primary are 0 unless counted
    uint64_t not_finite = 0;  // samples of `path` that are no number or infinite, unless not counted
    uint64_t overflowed = 0;  // traversal stacks that were full (debug programs only)
    CLARITY_MEMBERS(primary, shadow, secondary, dropped, not_finite, overflowed);
    RayCounts& operator+=(const RayCounts& more) {
        std::apply([&](auto&... sum) { std::apply([&](auto&... one) { ((sum += one), ...); }, members_of(more)); },
                   members_of(*this));
        return *this;
    }
};

// One device's part in a picture that several devices share.
struct DeviceShare {
    std::string id, name;
    double share = 0;                     // of the picture's rows, 0 to 1
    double device_ms = 0, wall_ms = 0;    // tracing, by the device's clock and by the clock of its host thread
    double tone_map_ms = 0, read_ms = 0;  // read_display(), by the device's clock
    unsigned launches = 0;
};

// Times and ray counts of the samples that one call has traced.
struct FrameStats : RayCounts {
    double device_ms = 0;   // kernels of these samples, by the device's clock
    double wall_ms = 0;     // the same by the host's clock, including waiting
    unsigned samples = 0;   // in the film now
    unsigned launches = 0;  // launches that traced these samples
    // The steps: trace, counters, adding samples. read_display() appends tone mapping and read-back.
    std::vector<KernelTime> kernels;
    // One for each device if several share the picture. The times above are then those of the slowest device.
    std::vector<DeviceShare> devices;
};

// What to tell a user of a picture with such samples, or with dropped rays. ray_slots: of the settings; 0: of `path`, which has
// none.
std::string not_finite_text(uint64_t samples);
std::string dropped_text(uint64_t rays, int ray_slots);

// Adds ray counts and launches only.
void add_rays(FrameStats& sum, const FrameStats& more);
// Adds ray counts, launches and times of work that ran one after the other. Times of kernels are added by name.
void add_stats(FrameStats& sum, const FrameStats& more);
// Adds the parts of the same devices in one piece of work after the other. Rows are those of the last piece.
void add_shares(std::vector<DeviceShare>& sum, const std::vector<DeviceShare>& more);
// Combines times of devices that ran side by side: the slowest device's time counts, by kernel name.
void merge_times(std::vector<KernelTime>& all, const std::vector<KernelTime>& one);

}  // namespace clarity
