// report.hpp -- the measured records as a page for people.
#pragma once
#include <string>

#include "bench/output/record.hpp"

namespace clarity::bench {

// Writes DIR/index.html (made if it is not there), self-contained, with the records as bench.json and bench.csv beside it.
// Throws Error(failed) that names the file.
void write_report(const std::string& folder, const BenchReport& report);

}  // namespace clarity::bench
