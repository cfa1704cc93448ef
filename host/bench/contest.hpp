// contest.hpp -- one case: everybody who takes part in it, measured in turns.
#pragma once
#include "bench/measure.hpp"
#include "bench/stand.hpp"

namespace clarity {

// One row for each variant on each device and each mode of each peer. Rows that cannot be measured say why. Throws Cancelled.
std::vector<BenchRecord> run_case(Stand& stand, const PluginRegistry& plugins, const BenchRequest& request, const BenchCase& c,
                                  const MeasureRules& rules, Progress& progress);

}  // namespace clarity
