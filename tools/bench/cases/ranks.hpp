// ranks.hpp -- starts the program anew: one picture by one process, by two, and so on, which mpirun starts and which share it;
// first pictures.
#pragma once
#include "tools/bench/run/bench.hpp"
#include "tools/bench/run/measure.hpp"

namespace clarity::bench {

// Returns a row for each variant and number of request.ranks. N ranks get the first N of options.devices; where those are
// fewer, several ranks use the same. A row is refused if the picture's file has other bytes than that of the first row and all
// devices are of one kind. Throws Cancelled.
std::vector<BenchRecord> measure_ranks(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, const MeasureRules& rules,
                                       Progress& progress);

// Measures how long a first picture takes. The program is started anew for each variant, in their order. If the label has
// "cold", the folders of compiled programs (ours, PoCL's, CUDA's) are empty; otherwise they are those of the variant before.
// time_ms: the time of compilation. Throws Cancelled.
std::vector<BenchRecord> measure_start(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, Progress& progress);

}  // namespace clarity::bench
