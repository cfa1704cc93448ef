// report_sections.hpp -- the parts of a report. Each is empty where nothing of its kind was measured.
#pragma once
#include <string>

#include "bench/report/report_series.hpp"

namespace clarity::bench {

std::string thesis_section(const BenchReport& report, const SeriesNames& names);      // the six charts, the demo, the aim
std::string packets_section(const BenchReport& report, const SeriesNames& names);     // packet size x lanes
std::string structures_section(const BenchReport& report, const SeriesNames& names);  // structures and peers on the same rays
std::string scale_section(const BenchReport& report, const SeriesNames& names);       // cost over triangles
std::string analysis_section(const BenchReport& report, const SeriesNames& names);    // what the tracer did
std::string left_out_section(const BenchReport& report, const SeriesNames& names);    // refused, failed, skipped
std::string machine_section(const BenchReport& report, const SeriesNames& names);     // machine, method, all figures

}  // namespace clarity::bench
