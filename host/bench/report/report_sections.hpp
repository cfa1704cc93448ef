// report_sections.hpp -- the sections of a report as markup. A section is empty if nothing of its kind was measured.
#pragma once
#include <string>

#include "bench/report/report_series.hpp"

namespace clarity::bench {

std::string thesis_section(const BenchReport& report, const SeriesNames& names);   // the thesis's six charts, its demo, its aim
std::string packets_section(const BenchReport& report, const SeriesNames& names);  // packet size by lanes
std::string structures_section(const BenchReport& report,
                               const SeriesNames& names);                           // structures and baselines on the same rays
std::string scale_section(const BenchReport& report, const SeriesNames& names);     // cost by number of triangles
std::string analysis_section(const BenchReport& report, const SeriesNames& names);  // counters of the tracer
std::string left_out_section(const BenchReport& report, const SeriesNames& names);  // refused, failed and skipped rows
std::string machine_section(const BenchReport& report, const SeriesNames& names);   // machine, method, all figures

}  // namespace clarity::bench
