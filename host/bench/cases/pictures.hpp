// pictures.hpp -- measures one picture with all its samples on one device, on two devices, and so on.
#pragma once
#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// Returns a row for each variant and number of devices: 1, 2, 4, ... and all. Wall times are from the call to tone-mapped
// pixels in host memory. A row is refused if its picture differs from that of one device: devices of one kind must agree
// exactly. Throws Cancelled.
std::vector<BenchRecord> measure_pictures(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                          const BenchCase& c, const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
