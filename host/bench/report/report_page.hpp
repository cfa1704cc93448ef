// report_page.hpp -- the records as one page of XHTML with all charts and styles inside, so that it needs no network and no
// script.
#pragma once
#include <string>

#include "bench/output/record.hpp"

namespace clarity::bench {

std::string report_page(const BenchReport& report);

}  // namespace clarity::bench
