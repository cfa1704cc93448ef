// output.hpp -- writes records as text: tables for the terminal, JSON, CSV.
#pragma once
#include <string>

#include "bench/output/record.hpp"

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
// Part of bench_table(): where the time of frames goes.
// Part of bench_table(): pictures rendered by ranks of MPI, and where their time goes.
std::string ranks_table(const BenchReport& report);
// Part of bench_table(): pictures rendered by several devices, compared with those of one.
std::string devices_table(const BenchReport& report);
// Part of bench_table(): models that move.
std::string moving_table(const BenchReport& report);
// Part of bench_table(): animations by one rule for refits and builds after another.
std::string policy_table(const BenchReport& report);
// Part of bench_table(): shapes and meshes of them, and their crossing points.
std::string shapes_table(const BenchReport& report);
// Part of bench_table(): paths of light.
std::string light_table(const BenchReport& report);
// Part of bench_table(): our speed compared with the fastest baseline's.
std::string speedup_table(const BenchReport& report);

}  // namespace clarity::bench
