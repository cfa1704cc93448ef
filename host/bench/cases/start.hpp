// start.hpp -- how long a first picture takes: the program is started anew, with and without what compilers keep on disk.
#pragma once
#include "bench/run/bench.hpp"

namespace clarity::bench {

// Returns a row for each variant, in their order. One whose label ends in "cold" is started with empty folders for what is kept
// (ours, PoCL's, CUDA's), any other one with those of the variant before it. Throws Cancelled.
std::vector<BenchRecord> measure_start(const BenchScene& scene, const PluginRegistry& plugins, const BenchRequest& request,
                                       const BenchCase& c, const BenchOptions& options, Progress& progress);

}  // namespace clarity::bench
