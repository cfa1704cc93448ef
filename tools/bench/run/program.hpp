// program.hpp -- runs a program of the bench's own and waits for its end.
#pragma once
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "tools/bench/output/record.hpp"

namespace clarity::bench {

// What a started program leaves behind.
struct Ended {
    int status = 0;  // as waitpid() tells it
    double ms = 0;
};

// Starts words[0], found by PATH, in a process group of its own, so that Ctrl-C reaches only us. messages: a file for its
// stdout and stderr; "": its stderr is ours, and its stdout goes nowhere. A cancelled `progress` ends it by SIGTERM, and by
// SIGKILL if that does not help. Throws Cancelled then, and Error(failed) with `install` at the end if it cannot be started.
Ended run_program(std::vector<std::string> words, const std::string& messages, const char* install, const Progress& progress);

// `clarity bench --threads 1,2,4`: the same run with several numbers of processors.

// Throws Error(usage) if this process may not use as many processors as one of the counts.
void check_thread_counts(const std::vector<unsigned>& counts);

// Runs the program with `words`, the arguments of `clarity bench` without those that say where records go, once for each count,
// and returns the reports. Drivers choose their threads when they are loaded, so each run is a process of its own, on the first
// processors of those that this process may use, with as many threads of PoCL. `progress` is told which run it is; if it is
// cancelled, the report of that run has the rows so far and is the last one. Throws Error(failed) if a run wrote no records.
std::vector<BenchReport> run_by_threads(const std::vector<std::string>& words, const std::vector<unsigned>& counts,
                                        Progress& progress);

}  // namespace clarity::bench
