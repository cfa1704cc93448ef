// motion.hpp -- runs a case of the suite `moving`: a model whose vertices all move, refitted or built anew.
#pragma once
#include "bench/run/fixture.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// Measures of the case: "refit", "rebuild", or a kind of rays, which are traced after either. Returns one row for each variant,
// and of the first two one for each quality of the baseline. A row which cannot be measured says why. Throws Cancelled.
std::vector<BenchRecord> measure_motion(Fixture& fixture, const PluginRegistry& plugins, const BenchRequest& request,
                                        const BenchCase& c, const MeasureRules& rules, Progress& progress);

}  // namespace clarity::bench
