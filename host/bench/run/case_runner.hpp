// case_runner.hpp -- one case: everybody who takes part in it, measured in turns.
#pragma once
#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// One row for each variant on each device and each mode of each peer. Rows that cannot be measured say why. Throws Cancelled.
std::vector<BenchRecord> run_case(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                  const BenchCase& c, const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
