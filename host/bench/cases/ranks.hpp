// ranks.hpp -- starts the program anew: one picture by one process, by two, and so on, which mpirun starts and which share it;
// first pictures.
#pragma once
#include "bench/run/bench.hpp"
#include "bench/run/measure.hpp"

namespace clarity::bench {

// Returns a row for each variant and number of request.ranks. N ranks get the first N of options.devices; where those are
// fewer, several ranks use the same. A row is refused if the picture's file has other bytes than that of the first row and all
// devices are of one kind. Throws Cancelled.
std::vector<BenchRecord> measure_ranks(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, const MeasureRules& rules,
                                       Progress& progress);

// How long a first picture takes: the program is started anew for each variant, in their order. One whose label has "cold"
// starts with empty folders for what is kept (ours, PoCL's, CUDA's), any other one with those of the variant before it. time_ms
// is the part that compiles. Throws Cancelled.
std::vector<BenchRecord> measure_start(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, Progress& progress);

}  // namespace clarity::bench
