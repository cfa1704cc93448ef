// row.hpp -- what a record says of its scene, device, settings and structure.
#pragma once
#include "bench/output/record.hpp"
#include "render/frame/renderer.hpp"

namespace clarity::bench {

void describe(BenchRecord& row, const Scene& scene);
void describe(BenchRecord& row, const DeviceInfo& device);
// Builders and peers.
void describe_host(BenchRecord& row, unsigned threads);
void describe(BenchRecord& row, const Settings& settings);
void describe(BenchRecord& row, const AccelData& accel);
void describe(BenchRecord& row, const Prepared& prepared);
// "max_leaf=4,bins=32"
std::string parameters_text(const rt_plugin& plugin, const ParameterValues& values);

}  // namespace clarity::bench
