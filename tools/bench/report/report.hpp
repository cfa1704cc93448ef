// report.hpp -- writes the records as a page for readers.
#pragma once
#include <string>

#include "tools/bench/output/record.hpp"

namespace clarity::bench {

// The page: the records as JSON, and a script (page.js) that draws them. Everything is inside, so that it needs no network.
std::string report_page(const BenchReport& report);

// Writes DIR/index.html, which is report_page(), and the records beside it as bench.json and bench.csv. Creates the folder if
// needed. Throws Error(failed) which names the file that cannot be written.
void write_report(const std::string& folder, const BenchReport& report);

}  // namespace clarity::bench
