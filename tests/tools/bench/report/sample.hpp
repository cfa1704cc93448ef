// sample.hpp -- records as a run could write them, made by formulas: every suite, two devices, baselines, and rows without
// figures.
#pragma once
#include "tools/bench/output/record.hpp"

namespace clarity::test {
using namespace bench;

BenchReport sample_report();

}  // namespace clarity::test
