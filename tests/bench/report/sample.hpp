// sample.hpp -- records as a run could give them, by formula: every suite, two devices, peers, and rows without figures.
#pragma once
#include "bench/output/record.hpp"

namespace clarity::test {
using namespace bench;

BenchReport sample_report();

}  // namespace clarity::test
