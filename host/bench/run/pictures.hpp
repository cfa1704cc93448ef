// pictures.hpp -- one picture, all its samples, by one device, by two of them, and so on.
#pragma once
#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// A row for each variant and number of devices: 1, 2, 4, ... and all. Wall times are all in, from the call to tone-mapped
// pixels in memory of the host. Rows whose picture differs from that of one device are refused: by a bit, where the devices are
// of one kind. Throws Cancelled.
std::vector<BenchRecord> measure_pictures(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                          const BenchCase& c, const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
