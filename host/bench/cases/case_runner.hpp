// case_runner.hpp -- runs one case: our variants and the baselines, measured interleaved.
#pragma once
#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// Returns one row for each variant on each device and each mode of each baseline. A row which cannot be measured says why.
// Throws Cancelled.
std::vector<BenchRecord> run_case(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                  const BenchCase& c, const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
