// report.hpp -- writes the records as a page for readers.
#pragma once
#include <string>

#include "bench/output/record.hpp"

namespace clarity::bench {

// Writes DIR/index.html, which is self-contained, and the records beside it as bench.json and bench.csv. Creates the folder if
// needed. Throws Error(failed) which names the file that cannot be written.
void write_report(const std::string& folder, const BenchReport& report);

}  // namespace clarity::bench
