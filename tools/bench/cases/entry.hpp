// entry.hpp -- one row of a case while it is being measured.
#pragma once
#include <functional>
#include <vector>

#include "tools/bench/run/measure.hpp"
#include "tools/bench/suites/suite.hpp"

namespace clarity::bench {

struct Entry {
    BenchRecord row;
    std::function<Sample()> once;              // runs one repetition; empty: the row is not timed
    std::function<void(BenchRecord&)> finish;  // adds what is counted rather than timed; may be empty
};

// A row which names the case and its scene, and nothing else.
BenchRecord make_row(const BenchCase& c);

// Calls `work` with the entry's row. Does nothing if the row has failed already or if `work` is empty. If `work` throws, the
// row is marked as skipped (the setting is not supported) or failed, with the reason. Throws Cancelled.
void run_or_mark_failed(Entry& entry, const std::function<void(BenchRecord&)>& work);

// Finishes all entries and returns their rows. is_timed: before that, measures those that can be timed, interleaved, and puts
// times and status into their rows. Throws Cancelled.
std::vector<BenchRecord> measured_rows(std::vector<Entry>& entries, bool is_timed, const MeasureRules& rules,
                                       Progress& progress);

void set_result(BenchRecord& row, const Measured& measured);
// Computes the rates (frames, triangles, rays a second) from times and counts. Does nothing unless the row's status is ok.
void set_rates(BenchRecord& row);

}  // namespace clarity::bench
