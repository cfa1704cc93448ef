// output.hpp -- writes records as text: tables for the terminal, JSON, CSV.
#pragma once
#include <string>

#include "tools/bench/output/record.hpp"

namespace clarity::bench {

// A JSON list of records which ends in a newline. Each record holds its machine and run, so that lists of several runs can be
// joined.
std::string bench_json(const BenchReport& report);
// One record of the list, indented as in the list, without a comma or newline after it.
std::string bench_json_row(const BenchReport& report, const BenchRecord& record);
// The same records as CSV (RFC 4180), one line per record; nested keys are joined with dots.
std::string bench_csv(const BenchReport& report);
// Reads the text of bench_json(). The end of the list may be missing, as after a kill. Throws Error(failed) for any other text.
BenchReport read_bench_json(const std::string& text);
// All tables for the terminal: one per suite and measure, at most 120 columns wide, then what was left out.
std::string bench_table(const BenchReport& report);
// Parts of bench_table() with one line a record: first pictures, devices, ranks, models that move, animations; and dropped
// rays.
std::string row_tables(const BenchReport& report);
std::string dropped_table(const BenchReport& report);
// Part of bench_table(): shapes and meshes of them, and their crossing points.
std::string shapes_table(const BenchReport& report);
// Part of bench_table(): errors of paths of light.
std::string light_table(const BenchReport& report);
// Part of bench_table(): our speed compared with the fastest baseline's.
std::string speedup_table(const BenchReport& report);
// Part of bench_table(): rows that were measured with several numbers of threads.
std::string threads_table(const BenchReport& report);

}  // namespace clarity::bench
