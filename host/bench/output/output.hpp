// output.hpp -- records as text: a table for the terminal, JSON, CSV.
#pragma once
#include <string>

#include "bench/output/record.hpp"

namespace clarity::bench {

// A list of records, each whole with machine and run, so that lists of several runs may be joined (DESIGN.md section 5). Ends
// in a newline.
std::string bench_json(const BenchReport& report);
// One of these records, indented as in the list, without a comma or newline behind it.
std::string bench_json_row(const BenchReport& report, const BenchRecord& record);
// The same as the list, a line a record, nested keys joined by a dot; RFC 4180.
std::string bench_csv(const BenchReport& report);
// Reads what bench_json wrote; the list may lack its end, as a run leaves it that was killed. Throws Error(failed): what is not
// understood.
BenchReport read_bench_json(const std::string& text);
// One table a suite and measure, at most 120 columns wide.
std::string bench_table(const BenchReport& report);
// Of these, where the time of frames goes.
std::string breakdown_table(const BenchReport& report);
// Pictures by several devices, by those of one.
std::string devices_table(const BenchReport& report);
// And ours by the best of the peers.
std::string speedup_table(const BenchReport& report);

}  // namespace clarity::bench
