// report_page.hpp -- the measured records as one page of XHTML, pictures and style inside: it needs no network and no script.
#pragma once
#include <string>

#include "bench/output/record.hpp"

namespace clarity::bench {

std::string report_page(const BenchReport& report);

}  // namespace clarity::bench
