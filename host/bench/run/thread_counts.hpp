// thread_counts.hpp -- `clarity bench --threads 1,2,4`: the same run with several numbers of processors.
#pragma once
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "bench/output/record.hpp"

namespace clarity::bench {

// Throws Error(usage) if this process may not use as many processors as one of the counts.
void check_thread_counts(const std::vector<unsigned>& counts);

// Runs the program with `words`, the arguments of `clarity bench` without those that say where records go, once for each count,
// and returns the reports. Drivers choose their threads when they are loaded, so each run is a process of its own, on the first
// processors of those that this process may use, with as many threads of PoCL. `progress` is told which run it is; if it is
// cancelled, the report of that run has the rows so far and is the last one. Throws Error(failed) if a run wrote no records.
std::vector<BenchReport> run_by_threads(const std::vector<std::string>& words, const std::vector<unsigned>& counts,
                                        Progress& progress);

}  // namespace clarity::bench
