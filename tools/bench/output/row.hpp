// row.hpp -- fills in a record's description of scene, device, settings and structure.
#pragma once
#include "device/device.hpp"
#include "launch/prepared.hpp"
#include "picture/frame_stats.hpp"
#include "scene/scene.hpp"
#include "structures/accel_build.hpp"
#include "tools/bench/output/record.hpp"
#include "view/settings/settings.hpp"

namespace clarity::bench {

void describe(BenchRecord& row, const Scene& scene);
void describe(BenchRecord& row, const DeviceInfo& device);
// For builders and baselines: the host's processor, with so many threads.
void describe_host(BenchRecord& row, unsigned threads);
void describe(BenchRecord& row, const Settings& settings);
void describe(BenchRecord& row, const AccelData& accel);
void describe(BenchRecord& row, const Prepared& prepared);
// Copies the numbers of rays by kind.
void set_ray_counts(BenchRecord& row, const FrameStats& stats);
// The parameters as text, "max_leaf=4,bins=32".
std::string parameters_text(const rt_plugin& plugin, const ParameterValues& values);

}  // namespace clarity::bench
